#include <lefort/io/read_text.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

namespace lefort::io {
namespace {

constexpr std::uintmax_t kMaxTransform = 1 << 20;  // Bytes; a rigid one has a few hundred.
constexpr std::string_view kTransformMagic = "#Insight Transform File V1.0";
constexpr double kRigid = 1e-4;             // Registrations write six digits.
constexpr double kMaxTranslation_mm = 1e5;  // As in plans.
constexpr std::string_view kSpaces = " \t\r";

tl::unexpected<Error> corrupt_transform(std::string what) {
  return fail(ErrorCode::kFileCorrupt, std::move(what));
}

/// The fields of a file before interpretation.
struct Parts {
  std::string type;  ///< "AffineTransform_double_3_3".
  std::vector<double> parameters, fixed;
};

std::string_view trimmed_text(std::string_view text) {
  const std::size_t start = text.find_first_not_of(kSpaces);
  if (start == std::string_view::npos) return {};
  return text.substr(start, text.find_last_not_of(kSpaces) - start + 1);
}

std::optional<std::vector<double>> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  for (text = trimmed_text(text); !text.empty(); text = trimmed_text(text)) {
    if (text.front() == '+') text.remove_prefix(1);
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
    text.remove_prefix(std::size_t(end - text.data()));
    if (!text.empty() && kSpaces.find(text.front()) == std::string_view::npos) return std::nullopt;
    numbers.push_back(number);
  }
  return numbers;
}

Result<Parts> read_parts(std::string_view text) {
  Parts parts;
  bool is_first = true;
  std::optional<std::vector<double>> parameters, fixed;
  for (Index number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed_text(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (is_first && line != kTransformMagic)
      return corrupt_transform(fmt::format("line 1 must be \"{}\"", kTransformMagic));
    is_first = false;
    if (line.empty() || line.front() == '#') continue;
    const std::size_t colon = line.find(':');
    const std::string_view key = trimmed_text(line.substr(0, colon));
    const std::string_view value = colon == std::string_view::npos ? "" : line.substr(colon + 1);
    if (key == "Transform") {
      if (!parts.type.empty())
        return fail(ErrorCode::kFileUnsupported, "it has several transforms, expected one");
      parts.type = trimmed_text(value);
    } else if (key == "Parameters" || key == "FixedParameters") {
      auto& target = key == "Parameters" ? parameters : fixed;
      if (target) return corrupt_transform(fmt::format("line {}: {} is repeated", number, key));
      target = numbers_in(value);
      if (!target)
        return corrupt_transform(fmt::format("line {}: not a list of finite numbers", number));
    } else {
      return corrupt_transform(
          fmt::format("line {}: neither Transform, Parameters nor FixedParameters", number));
    }
  }
  if (parts.type.empty()) return corrupt_transform("it names no Transform");
  if (!parameters) return corrupt_transform("it has no Parameters");
  parts.parameters = *std::move(parameters);
  if (fixed) parts.fixed = *std::move(fixed);
  return parts;
}

/// p -> matrix (p - center) + center + translation, as in the file.
struct Affine {
  Mat3 matrix = Mat3::Identity();
  Vec3 translation = Vec3::Zero();
  Vec3 center = Vec3::Zero();
};

Result<Affine> understand(const Parts& parts) {
  const auto is = [&](std::string_view name, std::string_view dimensions) {
    return parts.type == fmt::format("{}_double_{}", name, dimensions) ||
           parts.type == fmt::format("{}_float_{}", name, dimensions);
  };
  const bool is_matrix = is("AffineTransform", "3_3") || is("MatrixOffsetTransformBase", "3_3");
  const bool is_versor = is("VersorRigid3DTransform", "3_3");
  const bool is_shift = is("TranslationTransform", "3_3");
  if (!is_matrix && !is_versor && !is_shift)
    return fail(
        ErrorCode::kFileUnsupported,
        fmt::format(
            "a transform of type {} is not supported, expected AffineTransform_double_3_3, or a "
            "MatrixOffsetTransformBase, VersorRigid3DTransform or TranslationTransform",
            parts.type.substr(0, 60)));
  const std::size_t wanted = is_matrix ? 12 : is_versor ? 6 : 3;
  if (parts.parameters.size() != wanted)
    return corrupt_transform(
        fmt::format("{} Parameters, must be {}", parts.parameters.size(), wanted));
  if (!parts.fixed.empty() && parts.fixed.size() != 3)
    return corrupt_transform(fmt::format("{} FixedParameters, must be 3", parts.fixed.size()));
  Affine affine;
  const double* const p = parts.parameters.data();
  if (is_matrix) affine.matrix << p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8];
  if (is_versor) {
    const Vec3 v(p[0], p[1], p[2]);
    if (v.squaredNorm() > 1.0) return corrupt_transform("the versor is longer than 1");
    affine.matrix = Eigen::Quaterniond(std::sqrt(1.0 - v.squaredNorm()), v.x(), v.y(), v.z())
                        .toRotationMatrix();
  }
  affine.translation = Vec3(p[wanted - 3], p[wanted - 2], p[wanted - 1]);
  if (parts.fixed.size() == 3) affine.center = Vec3(parts.fixed[0], parts.fixed[1], parts.fixed[2]);
  return affine;
}

/// Returns why the transform is not rigid, or nothing.
std::optional<std::string> not_rigid(const Affine& affine) {
  if (!affine.matrix.allFinite() || !((affine.matrix.transpose() * affine.matrix).allFinite()))
    return "its numbers are too large";
  if (!(affine.matrix.determinant() > 0.0))
    return "it mirrors, expected a rotation and a translation";
  const double off =
      (affine.matrix.transpose() * affine.matrix - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kRigid))
    return fmt::format("it scales or shears by {:.2g}, expected a rotation and a translation",
                       0.5 * off);
  if (!(std::max(affine.translation.cwiseAbs().maxCoeff(), affine.center.cwiseAbs().maxCoeff()) <=
        kMaxTranslation_mm))
    return fmt::format("it translates by more than {:g} mm", kMaxTranslation_mm);
  return std::nullopt;
}

}  // namespace

Result<RigidTransform> parse_transform(std::string_view text) {
  LEFORT_TRY(const Parts parts, read_parts(text));
  LEFORT_TRY(const Affine affine, understand(parts));
  if (const auto why = not_rigid(affine)) return fail(ErrorCode::kFileUnsupported, *why);
  RigidTransform X_BL = RigidTransform::Identity();
  if (affine.matrix != Mat3::Identity())
    X_BL.linear() = Eigen::Quaterniond(affine.matrix).normalized().toRotationMatrix();
  X_BL.translation() = affine.center + affine.translation - X_BL.linear() * affine.center;
  return X_BL.inverse();
}

Result<RigidTransform> read_transform(const std::filesystem::path& file) {
  LEFORT_TRY(const std::string text, read_text(file, kMaxTransform));
  Result<RigidTransform> motion = parse_transform(text);
  if (!motion)
    return fail(motion.error().code,
                fmt::format("transform {}: {}", file.string(), motion.error().message));
  return motion;
}

Result<void> write_transform(const std::filesystem::path& file, const RigidTransform& X_LB) {
  const RigidTransform X_BL = X_LB.inverse();
  std::string numbers;
  for (Index row = 0; row < 3; ++row)
    for (Index column = 0; column < 3; ++column)
      numbers += fmt::format(" {}", X_BL.linear()(row, column));
  for (Index row = 0; row < 3; ++row) numbers += fmt::format(" {}", X_BL.translation()[row]);
  return write_text(file, fmt::format("{}\n#Transform 0\nTransform: AffineTransform_double_3_3\n"
                                      "Parameters:{}\nFixedParameters: 0 0 0\n",
                                      kTransformMagic, numbers));
}

}  // namespace lefort::io
