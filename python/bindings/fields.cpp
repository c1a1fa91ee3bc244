#include "fields.h"

#include <lefort/field/build/build_distance_field.h>
#include <lefort/io/field_file.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "call.h"
#include "docstring.h"
#include "meshes.h"

namespace lefort::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;
using field::DistanceField;
using field::Zone;

using SharedField = std::shared_ptr<DistanceField>;

constexpr Index kPointsPerBlock = 4096;  // Of a parallel query.

constexpr std::array<std::pair<const char*, field::FieldMethod>, 4> kMethods{
    {{"bricks", field::FieldMethod::kBricks},
     {"hybrid", field::FieldMethod::kHybrid},
     {"adaptive", field::FieldMethod::kAdaptive},
     {"uniform", field::FieldMethod::kUniform}}};

field::FieldMethod method_of(const std::string& name) {
  for (const auto& [known, method] : kMethods)
    if (name == known) return method;
  raise_invalid(fmt::format("method is \"{}\"; bricks, hybrid, adaptive or uniform wanted", name));
}

/// Beyond the band infinite, NaN if unknown: as DistanceField::distances().
double distance_of(Zone zone, double distance_mm) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  switch (zone) {
    case Zone::kBand:
      return distance_mm;
    case Zone::kOutside:
      return kInfinity;
    case Zone::kInside:
      return -kInfinity;
    default:
      return std::numeric_limits<double>::quiet_NaN();
  }
}

/// Samples the points block by block, in parallel and without the GIL; use(n, sample) for each.
template <class Use>
void visit_samples(const DistanceField& field, const Points& points, bool smooth, const Use& use) {
  if (smooth && !field.is_smooth())
    raise_invalid("the field was built without smooth=True, which smooth interpolation needs");
  const auto all = points.all();
  const WithoutGil without_gil;
  const auto sample_block = [&]<class Sample>(Sample, auto query) {
    parallel_for_blocks(
        points.count(),
        [&](Index begin, Index end) {
          std::vector<Sample> samples(std::size_t(end - begin));
          query(all.subspan(std::size_t(begin), samples.size()), std::span<Sample>(samples));
          for (Index n = begin; n < end; ++n) use(n, samples[std::size_t(n - begin)]);
        },
        kPointsPerBlock);
  };
  if (smooth)
    sample_block(field::SmoothSample{}, [&](auto from, auto to) { field.sample_smooth(from, to); });
  else
    sample_block(field::FieldSample{}, [&](auto from, auto to) { field.sample(from, to); });
}

py::array_t<double> distance(const DistanceField& field, const py::object& given, bool smooth) {
  const Points points(given, "points_B");
  py::array_t<double> distances(points.shape());
  double* const out = distances.mutable_data();
  visit_samples(field, points, smooth, [out](Index n, const auto& sample) {
    out[n] = distance_of(sample.zone, sample.distance_mm);
  });
  return distances;
}

py::array_t<double> gradient(const DistanceField& field, const py::object& given, bool smooth) {
  const Points points(given, "points_B");
  py::array_t<double> gradients(points.shape({3}));
  auto* const out = reinterpret_cast<Vec3*>(gradients.mutable_data());
  visit_samples(field, points, smooth,
                [out](Index n, const auto& sample) { out[n] = sample.gradient_B; });
  return gradients;
}

py::array_t<std::uint8_t> zone(const DistanceField& field, const py::object& given, bool smooth) {
  const Points points(given, "points_B");
  py::array_t<std::uint8_t> zones(points.shape());
  std::uint8_t* const out = zones.mutable_data();
  visit_samples(field, points, smooth,
                [out](Index n, const auto& sample) { out[n] = std::uint8_t(sample.zone); });
  return zones;
}

SharedField build(const geometry::TriangleMesh& surface_B,
                  const field::DistanceFieldOptions& options, const CallOptions& call_options) {
  return std::make_shared<DistanceField>(call(call_options, [&](Progress& progress) {
    return field::build_distance_field(surface_B, options, progress);
  }));
}

SharedField read_field(const fs::path& path) {
  return std::make_shared<DistanceField>(
      call({py::none(), nullptr, 0}, [&](Progress&) { return io::read_field(path); }));
}

std::string describe(const DistanceField& field) {
  return fmt::format("<lefort.DistanceField: {}^3 cells of {:.3g} mm, band {:.3g} mm, {:.1f} MB>",
                     field.frame().resolution, field.cell_mm(), field.band_mm(),
                     double(field.sample_bytes() + field.smooth_bytes()) * 1e-6);
}

/// The bytes of a field file, which are aligned.
SharedField from_bytes(const py::bytes& state) {
  const auto text = std::make_shared<const std::string>(state);
  return std::make_shared<DistanceField>(
      value_of(io::decode_field(std::as_bytes(std::span(text->data(), text->size())), text)));
}

/// Zone as an IntEnum, so that it compares with the values of zone().
void bind_zone(py::module_& module) {
  py::dict members;
  members["BAND"] = int(Zone::kBand);
  members["OUTSIDE"] = int(Zone::kOutside);
  members["INSIDE"] = int(Zone::kInside);
  members["UNKNOWN"] = int(Zone::kUnknown);
  const py::object zone = py::module_::import("enum").attr("IntEnum")(
      "Zone", members, py::arg("module") = "lefort._lefort");
  zone.attr("__doc__") = doc("field::FieldSample");
  module.attr("Zone") = zone;
}

void bind_queries(py::class_<DistanceField, SharedField>& fields) {
  fields
      .def("distance", &distance, py::arg("points_B"), py::kw_only(), py::arg("smooth") = false,
           doc("field::DistanceField::distances"))
      .def("gradient", &gradient, py::arg("points_B"), py::kw_only(), py::arg("smooth") = false,
           doc("field::FieldSample::gradient_B"))
      .def("zone", &zone, py::arg("points_B"), py::kw_only(), py::arg("smooth") = false,
           doc("field::Zone"));
}

}  // namespace

void bind_fields(py::module_& module) {
  bind_zone(module);
  py::class_<DistanceField, SharedField> fields(module, "DistanceField",
                                                doc("field::DistanceField"));
  bind_queries(fields);
  const field::DistanceFieldOptions defaults;
  fields
      .def_static(
          "build",
          [](const geometry::TriangleMesh& surface_B, int resolution, double band_mm,
             double tolerance_mm, double margin_mm, const std::string& method, bool smooth,
             const py::object& progress, const std::shared_ptr<CancelToken>& cancel, int threads) {
            field::DistanceFieldOptions options;
            options.method = method_of(method);
            options.resolution = resolution;
            options.band_mm = band_mm;
            options.tolerance_mm = tolerance_mm;
            options.margin_mm = margin_mm;
            options.smooth = smooth;
            return build(surface_B, options, {progress, cancel, threads});
          },
          py::arg("surface_B"), py::kw_only(), py::arg("resolution") = defaults.resolution,
          py::arg("band_mm") = defaults.band_mm, py::arg("tolerance_mm") = defaults.tolerance_mm,
          py::arg("margin_mm") = defaults.margin_mm, py::arg("method") = "bricks",
          py::arg("smooth") = defaults.smooth, py::arg("progress") = py::none(),
          py::arg("cancel") = py::none(), py::arg("threads") = 0,
          doc("field::build_distance_field"))
      .def_property_readonly("band_mm", &DistanceField::band_mm, doc("field::FieldFrame::band_mm"))
      .def_property_readonly("guaranteed_mm", &DistanceField::guaranteed_mm,
                             doc("field::FieldFrame::guaranteed_mm"))
      .def_property_readonly("cell_mm", &DistanceField::cell_mm, doc("field::FieldFrame::cell_mm"))
      .def_property_readonly(
          "resolution", [](const DistanceField& field) { return field.frame().resolution; },
          doc("field::FieldFrame::resolution"))
      .def_property_readonly(
          "is_closed", [](const DistanceField& field) { return field.frame().closed; },
          doc("field::FieldFrame::closed"))
      .def_property_readonly("is_smooth", &DistanceField::is_smooth,
                             doc("field::DistanceFieldOptions::smooth"))
      .def_property_readonly(
          "box_B",
          [](const DistanceField& field) {
            return py::make_tuple(array_of(field.box_B().min()), array_of(field.box_B().max()));
          },
          doc("field::FieldFrame"))
      .def_property_readonly("sample_bytes", &DistanceField::sample_bytes,
                             doc("field::DistanceField::sample_bytes"))
      .def("__repr__", &describe)
      .def(py::pickle([](const DistanceField& field) { return py::bytes(io::encode_field(field)); },
                      &from_bytes));
  module.def("read_field", &read_field, py::arg("path"), doc("io::read_field"));
  module.def(
      "write_field",
      [](const fs::path& path, const DistanceField& field) {
        call({py::none(), nullptr, 0}, [&](Progress&) { return io::write_field(path, field); });
      },
      py::arg("path"), py::arg("field"), doc("io::write_field"));
}

}  // namespace lefort::python
