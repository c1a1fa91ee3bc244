#include <lefort/plan/cephalometric_norms.h>

#include <array>

namespace lefort::plan {
namespace {

constexpr NormValue no_deviation(double mean) { return {mean, std::nullopt}; }
/// A length on films that are enlarged by 8 %.
constexpr NormValue on_mcnamara_film(double mean, double deviation) {
  return {mean / 1.08, deviation / 1.08};
}

constexpr const char* kSteiner = "Steiner 1953, adults with good occlusion";
constexpr const char* kDowns = "Downs 1948, 20 persons of 12 to 17 years";
constexpr const char* kMcNamara = "McNamara 1984, Ann Arbor sample, 111 adults";
constexpr const char* kMcNamaraUnverified = "McNamara 1984, 111 adults; not verified";
constexpr const char* kRicketts = "Ricketts 1981, at 18 years";
constexpr const char* kArnett = "Arnett et al. 1999, 46 adults; not verified";

constexpr NormValue kSna = no_deviation(82.0), kSnb = no_deviation(80.0), kAnb = no_deviation(2.0);
constexpr NormValue kFacial{87.8, 3.6}, kConvexity{0.0, 5.1}, kPlane{21.9, 3.2};
constexpr NormValue kDepth{88.0, 3.0}, kApoint{1.0, 2.0}, kAngle{23.0, 4.0}, kIncisor{1.0, 2.0},
    kLip{-3.75, 2.0};

constexpr std::array kNorms{
    CephalometricNorm{"Steiner", "SNA", kSna, kSna, kSteiner},
    CephalometricNorm{"Steiner", "SNB", kSnb, kSnb, kSteiner},
    CephalometricNorm{"Steiner", "ANB", kAnb, kAnb, kSteiner},
    CephalometricNorm{"Downs", "FH-NPg", kFacial, kFacial, kDowns},
    CephalometricNorm{"Downs", "NAPg", kConvexity, kConvexity, kDowns},
    CephalometricNorm{"Downs", "FH-MP", kPlane, kPlane, kDowns},
    CephalometricNorm{"McNamara", "A-Nperp", on_mcnamara_film(0.4, 2.3), on_mcnamara_film(1.1, 2.7),
                      kMcNamaraUnverified},
    CephalometricNorm{"McNamara", "Pg-Nperp", on_mcnamara_film(-1.8, 4.5),
                      on_mcnamara_film(-0.3, 3.8), kMcNamaraUnverified},
    CephalometricNorm{"McNamara", "Co-A", on_mcnamara_film(91.0, 4.3), on_mcnamara_film(99.8, 6.0),
                      kMcNamara},
    CephalometricNorm{"McNamara", "Co-Gn", on_mcnamara_film(120.2, 5.3),
                      on_mcnamara_film(134.3, 6.8), kMcNamara},
    CephalometricNorm{"McNamara", "ANS-Me", on_mcnamara_film(66.7, 4.1),
                      on_mcnamara_film(74.6, 5.0), kMcNamara},
    CephalometricNorm{"McNamara", "FH-MP", {22.7, 4.3}, {21.3, 3.9}, kMcNamaraUnverified},
    CephalometricNorm{"Ricketts", "FH-NPg", kDepth, kDepth, kRicketts},
    CephalometricNorm{"Ricketts", "A-NPg", kApoint, kApoint, kRicketts},
    CephalometricNorm{"Ricketts", "FH-MP", kAngle, kAngle, kRicketts},
    CephalometricNorm{"Ricketts", "L1-APg", kIncisor, kIncisor, kRicketts},
    CephalometricNorm{"Ricketts", "Li-E", kLip, kLip, kRicketts},
    CephalometricNorm{"Arnett", "Prn-TVL", {16.0, 1.4}, {17.4, 1.7}, kArnett},
    CephalometricNorm{"Arnett", "A'-TVL", {-0.1, 1.0}, {-0.3, 1.0}, kArnett},
    CephalometricNorm{"Arnett", "Ls-TVL", {3.7, 1.2}, {3.3, 1.7}, kArnett},
    CephalometricNorm{"Arnett", "Li-TVL", {1.9, 1.4}, {1.0, 2.2}, kArnett},
    CephalometricNorm{"Arnett", "B'-TVL", {-5.3, 1.5}, {-7.1, 1.6}, kArnett},
    CephalometricNorm{"Arnett", "Pg'-TVL", {-2.6, 1.9}, {-3.5, 1.8}, kArnett},
    CephalometricNorm{"Arnett", "N'-Me'", {124.6, 4.7}, {137.7, 6.5}, kArnett},
    CephalometricNorm{"Arnett", "Sn-Me'", {71.1, 3.5}, {81.1, 4.7}, kArnett},
};

}  // namespace

std::span<const CephalometricNorm> cephalometric_norms() { return kNorms; }

std::optional<double> deviation_from(const CephalometricNorm& norm, Sex sex, double value) {
  const NormValue& expected = sex == Sex::kFemale ? norm.female : norm.male;
  if (!expected.deviation || !(*expected.deviation > 0.0)) return std::nullopt;
  return (value - expected.mean) / *expected.deviation;
}

}  // namespace lefort::plan
