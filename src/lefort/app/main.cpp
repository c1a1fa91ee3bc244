#include <lefort/app/run_program.h>
#include <lefort/io/start_readers.h>

#include <cstdio>
#include <exception>

int main(int argc, char** argv) {
  try {
    lefort::io::start_readers();  // First, while there is nothing that readers should not have.
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lefort: the readers of files cannot start: %s\n", error.what());
    return 1;
  }
  const int exit_code = lefort::app::run_program(argc, argv);
  lefort::io::stop_readers();
  return exit_code;
}
