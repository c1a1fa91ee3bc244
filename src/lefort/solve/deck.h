/// \file
/// Input of `lefort solve`: materials, boundary conditions, loads, obstacles and solver options.
/// Sets and regions are names that prepare_deck() finds in the mesh.
#pragma once

#include <lefort/contact/distance_query.h>
#include <lefort/contact/integration.h>
#include <lefort/core/types.h>
#include <lefort/fem/materials/material.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/fem/solve/newton.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/solve/load_curve.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace lefort::solve {

/// Nodes in a box, including its sides.
struct NodesInBox {
  Box3 box_L;
};

/// Nodes near a plane.
struct NodesOnPlane {
  Vec3 point_L = Vec3::Zero();
  Vec3 normal_L = Vec3::UnitZ();  ///< Unit length.
  double within_mm = 1e-6;        ///< Max distance from the plane.
};

/// Nodes by number.
struct NodesByNumber {
  std::vector<std::int32_t> nodes;
};

/// The node closest to a point; of equally close nodes, the one with the lowest number.
struct NodeNearest {
  Vec3 point_L = Vec3::Zero();
};

/// All nodes of a region.
struct NodesOfRegion {
  std::string region;
};

/// A node set that the deck adds to those of the mesh.
struct SetChoice {
  std::string name;
  std::variant<NodesInBox, NodesOnPlane, NodesByNumber, NodeNearest, NodesOfRegion> nodes;
};

/// Material of a region.
struct RegionLaw {
  std::string region;  ///< Name or number; empty: all regions without a law of their own.
  fem::Material law;
  double density_t_per_mm3 = 0.0;  ///< >= 0; used by body forces only.
};

/// Prescribed displacement of a set; components without a value are free.
struct PrescribedSet {
  std::string set;
  std::array<std::optional<double>, 3> displacement_mm{};
  LoadCurve curve{};
};

/// A set with a prescribed rigid motion.
struct RigidlyMovedSet {
  std::string set;
  geometry::RigidPath path;
};

/// Dead load: force per reference area, with fixed direction.
struct Traction {
  std::string faces;
  Vec3 traction_mpa = Vec3::Zero();
  LoadCurve curve{};
};

/// Follower pressure: force per current area, against the current normal.
struct PressureLoad {
  std::string faces;
  double pressure_mpa = 0.0;  ///< Positive pushes on the body.
  LoadCurve curve{};
};

/// Force per reference volume: density times acceleration.
struct BodyForce {
  std::string region;  ///< Empty: all.
  Vec3 acceleration_mm_per_s2 = Vec3::Zero();
  LoadCurve curve{};
};

/// A rigid obstacle: faces may touch it without friction, but not enter it.
struct Obstacle {
  std::string name;
  std::string faces;
  geometry::RigidPath path;  ///< One keyframe without motion if stationary.
  /// Penalty stiffness k_c; default: stiffness_factor times Young's modulus of the stiffest region
  /// behind the faces, divided by the mean edge length of the faces. Default with weighted gaps:
  /// contact::weighted_stiffness_mpa_per_mm().
  std::optional<double> stiffness_mpa_per_mm;
  double stiffness_factor = 10.0;
  /// Contact snap distance: points of faces within this distance at rest count as being in contact.
  double contact_snap_mm = 0.0;
  contact::DetectionMethod detection = contact::DetectionMethod::kSmooth;
  contact::Integration integration = contact::Integration::kQuadrature;
  /// That of contact::hardening_law(), none by default; with weighted gaps that of
  /// contact::weighted_stiffness_mpa_per_mm(), by default contact::kWeightedTolerance_mm.
  std::optional<double> penetration_tolerance_mm = std::nullopt;
};

/// A point whose displacement is reported at every increment.
struct Probe {
  std::string name;
  std::variant<std::int32_t, Vec3> at;  ///< A node, or a point of the body at rest, in L.
};

struct Deck {
  std::vector<SetChoice> sets;
  std::vector<RegionLaw> laws;
  std::vector<PrescribedSet> displacements;
  std::vector<RigidlyMovedSet> motions;
  std::vector<Traction> tractions;
  std::vector<PressureLoad> pressures;
  std::vector<BodyForce> body_forces;
  std::vector<Obstacle> obstacles;
  std::vector<Probe> probes;
  std::vector<double> times;  ///< In (0, 1); an increment ends at each of them.
  fem::LoadStepOptions steps{.first_increment = 0.1, .min_increment = 1e-4};
  fem::NewtonOptions newton;
  linear::LinearSolverOptions linear_solver;
};

}  // namespace lefort::solve
