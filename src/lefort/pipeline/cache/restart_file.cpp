#include <lefort/core/version.h>
#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cache/restart_file.h>
#include <lefort/pipeline/cache/stage_keys.h>
#include <lefort/pipeline/prepare/cached_field.h>
#include <lefort/predict/tissue_boundary.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lefort::pipeline {
namespace {

// Raise with every change of the solver or of contact that may change the result of a step, and of
// this file's layout.
constexpr double kStepsRevision = 17;

constexpr std::string_view kMagic = "lefort restart 4\n";
constexpr std::size_t kHashDigits = 64;
constexpr std::uintmax_t kMaxRestartBytes = std::uintmax_t(64) << 30;

/// Appends values; the same visit() below reads them.
class Writer {
 public:
  template <class Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void operator()(Number& number) {
    text_.append(reinterpret_cast<const char*>(&number), sizeof(number));
  }
  void raw(void* data, std::size_t bytes) { text_.append(static_cast<const char*>(data), bytes); }
  template <class List>
  void size_of(List& list) {
    auto size = std::uint64_t(list.size());
    (*this)(size);
  }
  template <class Item, class Write>
  void items(std::vector<Item>& list, const Write& write) {
    size_of(list);
    for (Item& item : list) write(item);
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

/// Reads values. Missing ones are zero, and is_whole() is then false.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}
  template <class Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void operator()(Number& number) { raw(&number, sizeof(number)); }
  void operator()(bool& is_set) {
    std::uint8_t byte = 0;
    raw(&byte, sizeof(byte));
    is_whole_ = is_whole_ && byte <= 1;
    is_set = byte == 1;
  }
  void raw(void* data, std::size_t bytes) {
    is_whole_ = is_whole_ && bytes <= text_.size();
    if (!is_whole_ || bytes == 0) return;
    std::memcpy(data, text_.data(), bytes);
    text_.remove_prefix(bytes);
  }
  template <class List>
  void size_of(List& list) {
    std::uint64_t size = 0;
    (*this)(size);
    is_whole_ = is_whole_ && size <= text_.size() / sizeof(*list.data());
    if (is_whole_) list.resize(static_cast<decltype(list.size())>(size));
  }
  /// Reads the items of a list, whose memory grows with the bytes that are read.
  template <class Item, class Read>
  void items(std::vector<Item>& list, const Read& read) {
    std::uint64_t size = 0;
    (*this)(size);
    for (; size > 0 && is_whole_ && !text_.empty(); --size) read(list.emplace_back());
    is_whole_ = is_whole_ && size == 0;
  }
  [[nodiscard]] bool is_whole() const { return is_whole_ && text_.empty(); }

 private:
  std::string_view text_;
  bool is_whole_ = true;
};

// The members of a restart, to be written or read.

template <class Archive>
void visit(Archive& archive, std::string& text) {
  archive.size_of(text);
  archive.raw(text.data(), text.size());
}

template <class Archive>
void visit(Archive& archive, VectorX& vector) {
  archive.size_of(vector);
  archive.raw(vector.data(), std::size_t(vector.size()) * sizeof(double));
}

template <class Archive>
void visit(Archive& archive, std::vector<double>& list) {
  archive.size_of(list);
  archive.raw(list.data(), list.size() * sizeof(double));
}

template <class Archive>
void visit(Archive& archive, Vec3& vector) {
  archive.raw(vector.data(), 3 * sizeof(double));
}

template <class Archive, class Item>
void visit(Archive& archive, std::vector<Item>& list) {
  archive.items(list, [&](Item& item) { visit(archive, item); });
}

template <class Archive>
void visit(Archive& archive, RigidTransform& pose) {
  archive.raw(pose.matrix().data(), std::size_t(pose.matrix().size()) * sizeof(double));
}

template <class Archive>
void visit(Archive& archive, fem::NewtonIterate& at) {
  auto& [residual_n, residual_reference_n, energy_mj, step_length, tangent_blend, shift, contacts] =
      at;
  archive(residual_n);
  archive(residual_reference_n);
  archive(energy_mj);
  archive(step_length);
  archive(tangent_blend);
  archive(shift);
  archive(contacts);
}

template <class Archive>
void visit(Archive& archive, fem::LoadAttempt& attempt) {
  auto& [t_from, t_to, extrapolated, stop, reason, history] = attempt;
  archive(t_from);
  archive(t_to);
  archive(extrapolated);
  archive(stop);
  visit(archive, reason);
  visit(archive, history);
}

template <class Archive>
void visit(Archive& archive, contact::ContactStatistics& summary) {
  auto& [points, nodes, area_mm2, sampled_mm2, max_mm, mean_mm, max_from_rest_mm, mean_from_rest_mm,
         p99_from_rest_mm, max_bone_mm, p99_bone_mm, force_L_n, normal_force_n] = summary;
  archive(points);
  archive(nodes);
  archive(area_mm2);
  archive(sampled_mm2);
  archive(max_mm);
  archive(mean_mm);
  archive(max_from_rest_mm);
  archive(mean_from_rest_mm);
  archive(p99_from_rest_mm);
  archive(max_bone_mm);
  archive(p99_bone_mm);
  visit(archive, force_L_n);
  archive(normal_force_n);
}

template <class Archive>
void visit(Archive& archive, contact::SupportStatistics& supports) {
  auto& [nodes, max_slip_mm, max_opening_mm, max_compression_mm] = supports;
  archive(nodes);
  archive(max_slip_mm);
  archive(max_opening_mm);
  archive(max_compression_mm);
}

template <class Archive>
void visit(Archive& archive, predict::SegmentStep& segment) {
  auto& [X_LB, contact, supports] = segment;
  visit(archive, X_LB);
  visit(archive, contact);
  visit(archive, supports);
}

template <class Archive>
void visit(Archive& archive, predict::PredictionStep& step) {
  auto& [path_fraction, segments, displacement_mm, stationary_contact, stationary_supports, min_J,
         residual_n, relative_residual, attempts] = step;
  archive(path_fraction);
  visit(archive, segments);
  visit(archive, displacement_mm);
  visit(archive, stationary_contact);
  visit(archive, stationary_supports);
  archive(min_J);
  archive(residual_n);
  archive(relative_residual);
  visit(archive, attempts);
}

template <class Archive>
void visit(Archive& archive, fem::LoadState& state) {
  archive(state.t);
  visit(archive, state.u);
}

template <class Archive>
void visit(Archive& archive, predict::Restart& restart) {
  auto& [steps, stepper] = restart;
  visit(archive, steps);
  visit(archive, stepper.last);
  bool has_before = stepper.before_last.has_value();
  archive(has_before);
  if (has_before) {
    if (!stepper.before_last) stepper.before_last.emplace();
    visit(archive, *stepper.before_last);
  }
  archive(stepper.increment);
}

void add(io::Sha256& hash, const mesh::VolumeMesh& tissue) {
  hash.add(double(tissue.nodes_L.size()));
  for (const Vec3& p_L : tissue.nodes_L) hash.add(p_L);
  for (const mesh::ElementBlock& block : tissue.blocks) {
    hash.add(double(block.shape)).add(double(block.nodes.size()));
    for (const std::int32_t node : block.nodes) hash.add(double(node));
    for (const std::int32_t region : block.region) hash.add(double(region));
  }
  for (const char* set : {predict::sets::kMobilizedSegment, predict::sets::kFixed}) {
    const auto& nodes = tissue.node_sets.at(set);
    hash.add(double(nodes.size()));
    for (const std::int32_t node : nodes) hash.add(double(node));
  }
  for (const predict::BoundaryLabelStyle& label : predict::kBoundaryLabelStyles) {
    const auto set = tissue.node_sets.find(label.set);
    if (set == tissue.node_sets.end()) continue;  // Nothing was painted.
    hash.add(std::string_view(label.set)).add(double(set->second.size()));
    for (const std::int32_t node : set->second) hash.add(double(node));
  }
  const auto& faces = tissue.face_sets.at(predict::sets::kContact);
  hash.add(double(faces.size()));
  for (const mesh::Face& face : faces)
    for (const std::int32_t node : mesh::nodes_of(face)) hash.add(double(node));
}

void add(io::Sha256& hash, const predict::InterfaceMap& map) {
  hash.add(double(map.nodes.size())).add(double(map.planes.size()));
  for (const predict::NodeInterface& one : map.nodes) {
    const auto& [node, condition, rule, bone, may_separate] = one;
    hash.add(double(node)).add(double(condition)).add(double(bone)).add(double(may_separate));
    static_cast<void>(rule);
  }
  for (const predict::NodePlane& plane : map.planes)
    hash.add(double(plane.node))
        .add(plane.normal_L)
        .add(double(plane.segment))
        .add(plane.motion_fraction);
}

/// What contact reads in place of a bone.
void add_obstacle(io::Sha256& hash, const predict::ContactBone& bone, const io::PlanFile& plan) {
  const geometry::TriangleMesh& surface_B = predict::contact_surface_B(bone);
  hash.add(field_key(surface_B, contact_field_options(plan, surface_B)));
}

}  // namespace

// Structured bindings name every member: a new member fails to compile until it is in the key.
std::string restart_key(const PreparedCase& prepared) {
  const io::PlanFile& plan = prepared.plan;
  io::Sha256 hash;
  hash.add(kVersion).add(kStepsRevision);
  add(hash, prepared.model.tissue);
  hash.add(double(plan.segments.size()));
  for (const predict::ContactBone& segment : prepared.model.segments) {
    hash.add(segment.surface_B);
    add_obstacle(hash, segment, plan);
  }
  if (const auto& bone = prepared.model.stationary_bone) add_obstacle(hash, *bone, plan);
  for (const geometry::RigidPath& path : prepared.paths()) {
    const auto& [name, keyframes, steps, interpolation] = path;
    hash.add(double(steps)).add(double(keyframes.size())).add(double(interpolation));
    for (const geometry::Keyframe& keyframe : keyframes) {
      const auto& [at, translation_mm, rotation_rad, center_L] = keyframe;
      hash.add(at).add(translation_mm).add(rotation_rad).add(center_L);
    }
  }
  const auto& [young_mpa, poisson, element_size_mm, far_element_size_mm, element_order, margin_mm,
               skin, mucosa, muscle, face] = plan.tissue;
  static_cast<void>(face);  // The mesh itself is above.
  hash.add(young_mpa).add(poisson).add(element_size_mm).add(far_element_size_mm).add(margin_mm);
  hash.add(double(element_order));
  if (skin) {
    const auto& [thickness_mm, layers, skin_young_mpa, skin_poisson] = *skin;
    hash.add(thickness_mm).add(layers).add(skin_young_mpa).add(skin_poisson);
  }
  if (mucosa) hash.add(mucosa->young_mpa).add(mucosa->poisson);
  if (muscle) hash.add(std::string_view("muscle")).add(muscle->young_mpa).add(muscle->poisson);
  const auto& [interface, scan_boundary, cut_boundary, foundation_mm, elevation_margin_mm,
               joint_margin_mm, vestibule_mm, interface_layer_mm, contact_snap_mm, lips,
               lip_tone_mpa] = plan.boundary;
  hash.add(double(interface))
      .add(double(scan_boundary))
      .add(double(cut_boundary))
      .add(foundation_mm)
      .add(elevation_margin_mm.value_or(-1.0))
      .add(joint_margin_mm)
      .add(vestibule_mm)
      .add(interface_layer_mm)
      .add(contact_snap_mm)
      .add(lip_tone_mpa);
  hash.add(double(lips)).add(double(prepared.model.lips.pairs.size()));
  for (const predict::LipPair& pair : prepared.model.lips.pairs) {
    const auto& [upper, lower, area_mm2, normal_L] = pair;
    hash.add(double(upper)).add(double(lower)).add(area_mm2).add(normal_L);
  }
  add(hash, prepared.model.interface);
  const auto& [obstacle, named_factor, detection, integration, penetration_tolerance_mm] =
      plan.contact;
  hash.add(double(obstacle))
      .add(predict::stiffness_factor(plan.contact, plan.tissue))
      .add(double(detection))
      .add(double(integration))
      .add(penetration_tolerance_mm.value_or(0.0));
  const auto& [relative_tolerance, max_iterations, min_increment_ratio] = plan.solver;
  hash.add(relative_tolerance).add(double(max_iterations)).add(min_increment_ratio);
  return hash.hex();
}

Result<void> write_restart(const std::filesystem::path& path, const predict::Restart& restart) {
  Writer writer;
  predict::Restart copy = restart;  // visit() is shared with reading, so it needs a mutable object.
  visit(writer, copy);
  const std::string body = writer.take();
  return io::write_text(
      path, std::string(kMagic) + io::Sha256().add(std::string_view(body)).hex() + body);
}

Result<predict::Restart> read_restart(const std::filesystem::path& path) {
  LEFORT_TRY(const std::string text, io::read_text(path, kMaxRestartBytes));
  const auto damaged = [&] {
    return fail(ErrorCode::kFileCorrupt, path.string() + " is no restart file, or is damaged");
  };
  const std::string_view view(text);
  if (!view.starts_with(kMagic) || view.size() < kMagic.size() + kHashDigits) return damaged();
  const std::string_view body = view.substr(kMagic.size() + kHashDigits);
  if (io::Sha256().add(std::string_view(body)).hex() != view.substr(kMagic.size(), kHashDigits))
    return damaged();
  predict::Restart restart;
  Reader reader(body);
  visit(reader, restart);
  if (!reader.is_whole()) return damaged();
  return restart;
}

}  // namespace lefort::pipeline
