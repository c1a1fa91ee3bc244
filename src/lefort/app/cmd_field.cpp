#include <lefort/app/command.h>

#include <map>
#include <memory>
#include <string>

namespace lefort::app {
namespace {

void add_build(CLI::App& field, CommandContext& context) {
  const auto job = std::make_shared<BuildFieldJob>();
  CLI::App* const command =
      field.add_subcommand("build", "Compute the signed distance field of a surface");
  command->add_option("surface", job->surface, "Bone surface: .vtp, .stl, .ply or .obj")
      ->required();
  command->add_option("-o,--output", job->output, "Field to write: .field")->required();
  command
      ->add_option("--resolution", job->options.resolution,
                   "Cells along each side of the cube around the surface")
      ->check(CLI::IsMember({16, 32, 64, 128, 256, 512, 1024, 2048}))
      ->capture_default_str();
  command
      ->add_option("--band", job->options.band_mm,
                   "Samples up to this far from the surface are kept [mm]; 0 takes five cells")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--tolerance", job->options.tolerance_mm,
                   "Octrees unite cells while every sample is kept to this [mm]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--relative-tolerance", job->options.relative_tolerance,
                   "The same as a share of the cube's side, instead")
      ->check(CLI::Range(0.0, 1.0));
  command
      ->add_option("--side", job->options.side_mm,
                   "Side of the cube [mm]; 0 lays it close around the surface")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--method", job->options.method,
                   "bricks (fastest and smallest), hybrid (the paper's octree), adaptive "
                   "(Frisken's octree), uniform (Fuhrmann's grid)")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, field::FieldMethod>{{"bricks", field::FieldMethod::kBricks},
                                                    {"hybrid", field::FieldMethod::kHybrid},
                                                    {"adaptive", field::FieldMethod::kAdaptive},
                                                    {"uniform", field::FieldMethod::kUniform}}));
  command->add_flag("--smooth", job->options.smooth,
                    "Also prepare the twice differentiable reconstruction");
  command->footer("Example:\n  lefort field build skull.vtp -o skull.field --resolution 256");
  command->callback([job, &context] {
    context.run("field build", [&](Progress& progress) { return build_field(*job, progress); });
  });
}

void add_query(CLI::App& field, CommandContext& context) {
  const auto job = std::make_shared<QueryFieldJob>();
  CLI::App* const command =
      field.add_subcommand("query", "Distance, gradient and zone of points in a field");
  command->add_option("field", job->field, "Field made by `lefort field build`")->required();
  command
      ->add_option("points", job->points,
                   "Text file: x y z [mm, LPS] a line, separated by commas or spaces")
      ->required();
  command->add_option("-o,--output", job->output, "Table to write: .csv")->required();
  command->add_flag("--smooth", job->smooth,
                    "Use the twice differentiable reconstruction instead of the trilinear one");
  command->footer("Example:\n  lefort field query skull.field points.csv -o distances.csv");
  command->callback([job, &context] {
    context.run("field query", [&](Progress& progress) { return query_field(*job, progress); });
  });
}

}  // namespace

void add_field_command(CLI::App& cli, CommandContext& context) {
  CLI::App* const field = cli.add_subcommand("field", "Signed distance fields of bones");
  field->require_subcommand(1);
  add_build(*field, context);
  add_query(*field, context);
}

}  // namespace lefort::app
