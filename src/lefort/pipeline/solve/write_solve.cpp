#include <lefort/core/units.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/solve/write_solve.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>
#include <system_error>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSeries = "solve.pvd";
constexpr const char* kIncompleteSeries = "solve_incomplete.pvd";

double von_mises(const Mat3& sigma) {
  const Mat3 deviator = sigma - sigma.trace() / 3.0 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

template <class Value, class Get>
std::vector<Value> each(const std::vector<fem::ElementState>& elements, const Get& get) {
  std::vector<Value> values;
  values.reserve(elements.size());
  for (const fem::ElementState& element : elements) values.push_back(get(element));
  return values;
}

void add_element_fields(const io::WrittenFields& wanted,
                        const std::vector<fem::ElementState>& elements, io::VtuFields& fields) {
  const auto add = [&]<class Value>(const char* name, const std::vector<Value>& values) {
    fields.elements.push_back(io::vtu_array(name, std::span<const Value>(values)));
  };
  if (wanted.stress) {
    add("cauchy_stress_kpa", each<Mat3>(elements, [](const fem::ElementState& e) {
          return Mat3(e.cauchy_mpa * kpa_from_mpa(1.0));
        }));
    add("von_mises_kpa", each<double>(elements, [](const fem::ElementState& e) {
          return kpa_from_mpa(von_mises(e.cauchy_mpa));
        }));
  }
  if (wanted.volume_ratio)
    add("volume_ratio",
        each<double>(elements, [](const fem::ElementState& e) { return e.min_volume_ratio; }));
  if (wanted.stretches)
    add("principal_stretches",
        each<Vec3>(elements, [](const fem::ElementState& e) { return e.stretches; }));
  if (wanted.energy)
    add("energy_density_kpa", each<double>(elements, [](const fem::ElementState& e) {
          return kpa_from_mpa(e.energy_density_mpa);
        }));
}

/// Pressure and gap at the nodes of contact faces; elsewhere 0 and NaN.
void add_contact_fields(const std::string& obstacle,
                        const std::vector<contact::NodalContact>& nodal_contacts, Index nodes,
                        io::VtuFields& fields) {
  std::vector<double> pressure_kpa(std::size_t(nodes), 0.0);
  std::vector<double> gap_mm(std::size_t(nodes), std::numeric_limits<double>::quiet_NaN());
  for (const contact::NodalContact& node : nodal_contacts) {
    pressure_kpa[std::size_t(node.node)] = kpa_from_mpa(node.pressure_mpa);
    gap_mm[std::size_t(node.node)] = node.gap_mm;
  }
  fields.nodes.push_back(
      io::vtu_array(obstacle + "_pressure_kpa", std::span<const double>(pressure_kpa)));
  fields.nodes.push_back(io::vtu_array(obstacle + "_gap_mm", std::span<const double>(gap_mm)));
}

std::vector<Vec3> as_vectors(const VectorX& u) {
  std::vector<Vec3> vectors(std::size_t(u.size() / 3));
  for (std::size_t n = 0; n < vectors.size(); ++n) vectors[n] = u.segment<3>(Index(3 * n));
  return vectors;
}

io::VtuFields fields_of(const io::WrittenFields& wanted, const solve::Deck& deck,
                        const solve::Increment& increment) {
  io::VtuFields fields;
  const std::vector<Vec3> displacement_mm = as_vectors(increment.u);
  if (wanted.displacement)
    fields.nodes.push_back(
        io::vtu_array("displacement_mm", std::span<const Vec3>(displacement_mm)));
  add_element_fields(wanted, increment.elements, fields);
  if (wanted.contact)
    for (std::size_t i = 0; i < deck.obstacles.size(); ++i)
      add_contact_fields(deck.obstacles[i].name, increment.nodal_contacts[i],
                         Index(displacement_mm.size()), fields);
  return fields;
}

/// As SolveWriter::last_step() names them: "step_", four digits or more, ".vtu".
bool is_step_file(std::string_view name) {
  constexpr std::string_view kBegin = "step_", kEnd = ".vtu";
  constexpr std::size_t kFewestDigits = 4;
  if (!name.starts_with(kBegin) || !name.ends_with(kEnd)) return false;
  if (name.size() < kBegin.size() + kFewestDigits + kEnd.size()) return false;
  name.remove_prefix(kBegin.size());
  name.remove_suffix(kEnd.size());
  return name.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Names of the step files listed in a series in the folder.
std::set<std::string> listed_steps(const fs::path& folder) {
  constexpr std::string_view kFile = "file=\"";
  constexpr std::uintmax_t kMaxSeries = 100'000'000;
  std::set<std::string> names;
  for (const char* series : {kSeries, kIncompleteSeries}) {
    const Result<std::string> text = io::read_text(folder / series, kMaxSeries);
    for (std::size_t at = text ? text->find(kFile) : std::string::npos; at != std::string::npos;
         at = text->find(kFile, at)) {
      at += kFile.size();
      std::string name = text->substr(at, text->find('"', at) - at);
      if (is_step_file(name)) names.insert(std::move(name));
    }
  }
  return names;
}

/// Result files in the folder, solve.json first.
std::vector<fs::path> result_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const char* name : {"solve.json", kSeries, kIncompleteSeries, "probes.csv"})
    if (fs::exists(folder / name, error)) files.push_back(folder / name);
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (is_step_file(entry->path().filename().string())) files.push_back(entry->path());
  return files;
}

std::string csv_row(double time, const std::vector<Vec3>& probes_mm) {
  std::string row = fmt::format("{}", time);
  for (const Vec3& u : probes_mm) row += fmt::format(",{},{},{}", u.x(), u.y(), u.z());
  return row + "\n";
}

}  // namespace

Result<void> check_inputs_are_kept(const fs::path& folder, std::span<const fs::path> inputs) {
  std::error_code error;
  for (const fs::path& file : result_files(folder))
    for (const fs::path& input : inputs)
      if (fs::equivalent(file, input, error))
        return fail(ErrorCode::kFileUnwritable,
                    fmt::format("{} is read by this run and would be overwritten; choose another "
                                "output folder",
                                file.string()));
  return {};
}

Result<void> remove_solve_results(const fs::path& folder) {
  const std::vector<fs::path> files = result_files(folder);
  const std::set<std::string> steps = listed_steps(folder);  // Every run writes at least one.
  for (const fs::path& file : files) {
    const std::string name = file.filename().string();
    if (is_step_file(name) ? !steps.contains(name) : steps.empty())
      return fail(ErrorCode::kFileUnwritable,
                  fmt::format("{} exists, and no {} of an earlier run lists it; "
                              "move it or choose another output folder",
                              file.string(), kSeries));
  }
  return io::remove_earlier_files(files);
}

fs::path SolveWriter::last_step() const {
  return folder_ / fmt::format("step_{:04d}.vtu", last_written_);
}

Result<void> SolveWriter::write_step(int number, double time, const io::VtuFields& fields) {
  last_written_ = number;
  LEFORT_TRY_VOID(io::write_vtu(last_step(), prepared_.mesh, fields));
  series_.push_back({time, last_step().filename().string()});
  return io::write_pvd(folder_ / kIncompleteSeries, series_);
}

Result<void> SolveWriter::complete_series() const {
  LEFORT_TRY_VOID(io::write_pvd(folder_ / kSeries, series_));
  std::error_code error;
  fs::remove(folder_ / kIncompleteSeries, error);
  if (!error) return {};
  return fail(ErrorCode::kFileUnwritable,
              fmt::format("{} cannot be removed: {}", (folder_ / kIncompleteSeries).string(),
                          error.message()));
}

Result<void> SolveWriter::begin() {
  probes_csv_ = "time";
  for (const solve::Probe& probe : file_.deck.probes)
    for (const char* component : {"x_mm", "y_mm", "z_mm"})
      probes_csv_ += fmt::format(",{}_{}", probe.name, component);
  probes_csv_ += "\n";
  probes_csv_ += csv_row(0.0, std::vector<Vec3>(file_.deck.probes.size(), Vec3::Zero()));

  const std::vector<Vec3> none(prepared_.mesh.nodes_L.size(), Vec3::Zero());
  io::VtuFields fields;
  if (file_.fields.displacement)
    fields.nodes.push_back(io::vtu_array("displacement_mm", std::span<const Vec3>(none)));
  return write_step(0, 0.0, fields);
}

bool SolveWriter::is_wanted(const solve::Increment& increment) const {
  if (file_.every == io::WriteEvery::kIncrement) return true;
  if (file_.every == io::WriteEvery::kLast) return false;
  const std::vector<double>& times = file_.deck.times;
  return std::any_of(times.begin(), times.end(), [&](double time) {
    return std::abs(time - increment.time) <= solve::kSameTime;
  });
}

Result<void> SolveWriter::add(const solve::Increment& increment) {
  increments_.push_back(increment_json(prepared_, increment));
  probes_csv_ += csv_row(increment.time, increment.probes_mm);
  if (!is_wanted(increment)) return {};
  return write_step(increment.number, increment.time,
                    fields_of(file_.fields, file_.deck, increment));
}

Result<nlohmann::ordered_json> SolveWriter::finish(const SolveInputs& inputs,
                                                   const solve::DeckRun& run,
                                                   const PhaseClock& clock) {
  if (run.last && last_written_ != run.last->number)
    LEFORT_TRY_VOID(write_step(run.last->number, run.last->time,
                               fields_of(file_.fields, file_.deck, *run.last)));
  if (run.completed()) LEFORT_TRY_VOID(complete_series());
  if (!file_.deck.probes.empty())
    LEFORT_TRY_VOID(io::write_text(folder_ / "probes.csv", probes_csv_));
  nlohmann::ordered_json json = solve_json(file_, prepared_, inputs, increments_, run,
                                           last_step().filename().string(), clock);
  LEFORT_TRY_VOID(io::write_text(
      folder_ / "solve.json",
      json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n"));
  return json;
}

}  // namespace lefort::pipeline
