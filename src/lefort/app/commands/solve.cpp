#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/solve.h>

#include <memory>

namespace lefort::app {

void add_solve_command(CLI::App& cli, CommandContext& context) {
  const auto job = std::make_shared<pipeline::SolveJob>();
  CLI::App* const command =
      cli.add_subcommand("solve", "Solve the equilibrium of a body on a given mesh");
  mark_path(command->add_option("deck", job->deck, "Deck (contract/deck.schema.json)"),
            PathKind::kDeck)
      ->required();
  mark_path(command->add_option("-o,--output", job->output, "Folder for the results"),
            PathKind::kNewFolder)
      ->required();
  command->add_flag("--check", job->check_only,
                    "Read and check the deck and its mesh; solve and write nothing");
  command->footer(
      "Examples:\n"
      "  lefort solve examples/solve/stretch.json -o stretch/\n"
      "  lefort solve examples/solve/indent.json -o indent/ --threads 2 --json\n"
      "Writes solve.pvd with a step_NNNN.vtu for each increment (ParaView: Warp By Vector),\n"
      "probes.csv and solve.json. A run that ends early keeps its last converged step; its\n"
      "series is solve_incomplete.pvd, and solve.json reports it. Decks: docs/guide/solve.md.\n"
      "Not for clinical use.");
  command->callback([job, &context] {
    job->quiet = context.quiet;
    context.run("solve", [&](Progress& progress) { return pipeline::solve_deck(*job, progress); });
  });
}

}  // namespace lefort::app
