#include <lefort/app/commands/command.h>
#include <lefort/app/commands/path_kind.h>
#include <lefort/pipeline/field.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace lefort::app {
namespace {

/// Accepts names only; CLI11's own transformer also shows and accepts the numbers.
template <class Value>
CLI::Validator one_of(const std::map<std::string, Value>& values) {
  std::string names;
  for (const auto& [name, value] : values) names += (names.empty() ? "{" : ",") + name;
  names += "}";
  return {[values, names](std::string& input) -> std::string {
            const auto found = values.find(input);
            if (found == values.end()) return input + " not in " + names;
            input = std::to_string(int(found->second));
            return {};
          },
          names};
}

void add_build(CLI::App& field, CommandContext& context) {
  const auto job = std::make_shared<pipeline::BuildFieldJob>();
  CLI::App* const command =
      field.add_subcommand("build", "Compute the signed distance field of a surface");
  mark_path(command->add_option("surface", job->surface, "Bone surface: .vtp, .stl, .ply or .obj"),
            PathKind::kSurface)
      ->required();
  mark_path(command->add_option("-o,--output", job->output, "Field to write: .field"),
            PathKind::kNewField)
      ->required();
  command
      ->add_option("--resolution", job->options.resolution,
                   "Cells along each side of the cube around the surface")
      ->check(CLI::IsMember({16, 32, 64, 128, 256, 512, 1024, 2048}))
      ->capture_default_str();
  command
      ->add_option("--band", job->options.band_mm,
                   "Band: largest distance of samples from the surface [mm]; 0: five cells")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--tolerance", job->options.tolerance_mm,
                   "Octrees: largest error of a sample when cells are merged [mm]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--relative-tolerance", job->options.relative_tolerance,
                   "As --tolerance, but as a fraction of the side of the cube; replaces it")
      ->check(CLI::Range(0.0, 1.0));
  command
      ->add_option("--domain-size", job->options.side_mm,
                   "Side of the cube [mm]; 0 fits it to the surface and the band")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--method", job->options.method,
                   "bricks (fastest and smallest), hybrid (the paper's octree), adaptive "
                   "(Frisken's octree), uniform (Fuhrmann's grid)")
      ->transform(one_of<field::FieldMethod>({{"bricks", field::FieldMethod::kBricks},
                                              {"hybrid", field::FieldMethod::kHybrid},
                                              {"adaptive", field::FieldMethod::kAdaptive},
                                              {"uniform", field::FieldMethod::kUniform}}))
      ->type_name("TEXT")
      ->default_str("bricks");
  command->add_flag("--smooth", job->options.smooth,
                    "Also prepare the differentiable reconstruction");
  command->footer("Example:\n  lefort field build skull.vtp -o skull.field --resolution 256");
  command->callback([job, &context] {
    context.run("field build",
                [&](Progress& progress) { return pipeline::build_field(*job, progress); });
  });
}

void add_query(CLI::App& field, CommandContext& context) {
  const auto job = std::make_shared<pipeline::QueryFieldJob>();
  CLI::App* const command =
      field.add_subcommand("query", "Distance, gradient and zone of points in a field");
  mark_path(command->add_option("field", job->field, "Field made by `lefort field build`"),
            PathKind::kField)
      ->required();
  mark_path(command->add_option("points", job->points,
                                "Text file: x y z [mm, LPS] a line, separated by commas or spaces"),
            PathKind::kPoints)
      ->required();
  mark_path(command->add_option("-o,--output", job->output, "Table to write: .csv"),
            PathKind::kNewTable)
      ->required();
  command->add_flag("--smooth", job->smooth,
                    "Use the differentiable reconstruction instead of the trilinear one");
  command->footer("Example:\n  lefort field query skull.field points.csv -o distances.csv");
  command->callback([job, &context] {
    context.run("field query",
                [&](Progress& progress) { return pipeline::query_field(*job, progress); });
  });
}

void add_region(CLI::App& command, std::vector<double>& region_mm) {
  command
      .add_option("--region", region_mm,
                  "Only this box [mm, LPS]: from and to along x, y and z, six numbers")
      ->expected(6)
      ->delimiter(',');
}

void add_export(CLI::App& field, CommandContext& context) {
  const auto job = std::make_shared<pipeline::ExportFieldJob>();
  CLI::App* const command =
      field.add_subcommand("export", "The field as an OpenVDB level set or an NRRD volume");
  mark_path(command->add_option("field", job->field, "Field made by `lefort field build`"),
            PathKind::kField)
      ->required();
  mark_path(command->add_option("-o,--output", job->output,
                                "File to write: .vdb (sparse) or .nrrd (every sample of the box)"),
            PathKind::kNewExport)
      ->required();
  add_region(*command, job->region_mm);
  command->add_option("--stride", job->every, "Each n-th sample along each axis")
      ->check(CLI::Range(1, 2048))
      ->capture_default_str();
  command->footer(
      "Beyond the band samples are +band outside and -band inside; unknown ones are inactive in\n"
      ".vdb and NaN in .nrrd. Keys of the file state this (docs/reference/field-format.md).\n"
      "Examples:\n"
      "  lefort field export skull.field -o skull.vdb\n"
      "  lefort field export skull.field -o skull.nrrd --stride 2\n"
      "  lefort field export skull.field -o orbit.nrrd --region 80 130 20 70 30 80");
  command->callback([job, &context] {
    context.run("field export",
                [&](Progress& progress) { return pipeline::export_field(*job, progress); });
  });
}

void add_slice(CLI::App& field, CommandContext& context) {
  const auto job = std::make_shared<pipeline::SliceFieldJob>();
  CLI::App* const command = field.add_subcommand("slice", "A picture of a plane through the field");
  mark_path(command->add_option("field", job->field, "Field made by `lefort field build`"),
            PathKind::kField)
      ->required();
  mark_path(command->add_option("-o,--output", job->output, "Picture to write: .png"),
            PathKind::kNewPicture)
      ->required();
  command
      ->add_option("--axis", job->axis,
                   "Axis across the plane: x (sagittal), y (coronal) or z (axial)")
      ->required()
      ->transform(one_of<int>({{"x", 0}, {"y", 1}, {"z", 2}}))
      ->type_name("TEXT");
  command->add_option("--at", job->at_mm, "Where the plane cuts the axis [mm, LPS]")->required();
  CLI::Option* const width =
      command->add_option("--width", job->width_px, "Pixels across the plane")
          ->check(CLI::Range(64, 12000))
          ->capture_default_str();
  command
      ->add_option("--stride", job->every, "Instead of --width: one pixel per n cells of the field")
      ->check(CLI::Range(1, 2048))
      ->excludes(width);
  add_region(*command, job->region_mm);
  mark_path(command->add_option("--mesh", job->mesh,
                                "Surface whose section is drawn: .vtp, .stl, .ply or .obj"),
            PathKind::kSurface);
  command->add_flag("--smooth", job->smooth,
                    "Use the differentiable reconstruction instead of the trilinear one");
  command->footer(
      "Axial planes are seen from the feet, coronal ones from the front, sagittal ones from the\n"
      "left. --json reports distances, areas and the length of the zero line.\n"
      "Examples:\n"
      "  lefort field slice skull.field -o axial.png --axis z --at 40\n"
      "  lefort field slice skull.field -o orbit.png --axis y --at 50 --mesh skull.vtp \\\n"
      "    --region 80 130 20 70 30 80");
  command->callback([job, &context] {
    context.run("field slice",
                [&](Progress& progress) { return pipeline::slice_field(*job, progress); });
  });
}

void add_info(CLI::App& field, CommandContext& context) {
  const auto file = std::make_shared<std::filesystem::path>();
  CLI::App* const command =
      field.add_subcommand("info", "Show the kind, size and checksum of a field");
  mark_path(command->add_option("field", *file, "Field made by `lefort field build`"),
            PathKind::kField)
      ->required();
  command->footer("Example:\n  lefort field info skull.field --json");
  command->callback([file, &context] {
    context.run("field info",
                [&](Progress& progress) { return pipeline::describe_field(*file, progress); });
  });
}

}  // namespace

void add_field_command(CLI::App& cli, CommandContext& context) {
  CLI::App* const field = cli.add_subcommand("field", "Signed distance fields of bones");
  field->require_subcommand(1);
  add_build(*field, context);
  add_query(*field, context);
  add_export(*field, context);
  add_slice(*field, context);
  add_info(*field, context);
}

}  // namespace lefort::app
