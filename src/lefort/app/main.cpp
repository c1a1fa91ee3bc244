#include <lefort/app/run_program.h>
#include <lefort/io/start_readers.h>

int main(int argc, char** argv) {
  lefort::io::start_readers();  // First, while there is nothing that readers should not have.
  const int exit_code = lefort::app::run_program(argc, argv);
  lefort::io::stop_readers();
  return exit_code;
}
