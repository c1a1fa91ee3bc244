// Solves a deck with the libraries of lefort: use_lefort DECK OUTPUT_FOLDER
#include <lefort/io/start_readers.h>
#include <lefort/pipeline/solve.h>

#include <cstdio>
#include <string>
#include <string_view>

namespace {

/// Shows the stages and what the solver notes.
class Lines final : public lefort::Progress {
 public:
  void begin_stage(std::string_view name) override { print("stage", name); }
  void note(std::string_view sentence) override { print("note", sentence); }

 private:
  static void print(const char* kind, std::string_view text) {
    std::printf("%s: %s\n", kind, std::string(text).c_str());
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: use_lefort DECK OUTPUT_FOLDER\n");
    return 2;
  }
  lefort::io::start_readers();  // First: files are read in a process without privileges.
  Lines progress;
  const auto summary =
      lefort::pipeline::solve_deck({.quiet = true, .deck = argv[1], .output = argv[2]}, progress);
  if (summary) {
    std::printf("%s\n", summary->text.c_str());
  } else {
    std::fprintf(stderr, "use_lefort: %s\n", summary.error().message.c_str());
  }
  lefort::io::stop_readers();
  return summary ? 0 : 1;
}
