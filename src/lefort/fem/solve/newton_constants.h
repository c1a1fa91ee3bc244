/// \file
/// Constants of solve_newton(), with their sources. What a user may change is in NewtonOptions.
/// Values without a source are ours; the tests named here are in tests/fem/test_newton.cpp.
#pragma once

namespace lefort::fem::internal {

// Diagonal shift tau (\cite nocedal2006, algorithm 3.3). The shift is relative to the diagonal.

/// First tau; the algorithm calls it beta and uses this value.
inline constexpr double kFirstShift = 1e-3;
/// Factor from one tau to the next. The algorithm uses 2 and permits larger factors; each trial
/// costs a factorization.
inline constexpr double kShiftGrowth = 4.0;
/// Absolute values of diagonal entries below this fraction of their mean are raised to it.
inline constexpr double kMinDiagonal = 1e-3;

// Tangent blend beta, the fraction of the stabilized tangent.

/// First beta (test PrefersTheStabilizedTangentToAShift).
inline constexpr double kFirstBlend = 0.25;
/// Factor from one beta to the next.
inline constexpr double kBlendGrowth = 2.0;

// Backtracking. The step is multiplied by the zero of the interpolated slope, restricted to
// [kMaxContraction, kMinContraction] (\cite nocedal2006, section 3.5: safeguards).

inline constexpr double kMinContraction = 0.5;
inline constexpr double kMaxContraction = 0.1;
/// If alpha of the accepted step is less than this, the next tangent blend starts higher.
inline constexpr double kShortStep = 0.5;

// Expansion of a step by a blended or shifted tangent (test
// LeavesASaddleInFewStepsHoweverStiffTheStabilizedTangent).

/// c_2 of the curvature condition (\cite nocedal2006, equation (3.5)): the step is expanded while
/// the slope at its end is below c_2 times that at its start.
inline constexpr double kSlopeReduction = 0.3;
inline constexpr double kMinExpansion = 1.5;
inline constexpr double kMaxExpansion = 4.0;

// Antisymmetric part A of the tangent, solved by GMRES.

/// A is neglected if its largest entry is at most this fraction of the largest of K: it is then the
/// round-off of contributions that cancel, as where a pressure's border slides in a plane.
inline constexpr double kAntisymmetricRoundOff = 1e-10;
inline constexpr int kMaxGmresIterations = 200;
/// Tolerance of GMRES as a multiple of that of the symmetric solve: an iteration costs little
/// compared with the factorization that is its preconditioner.
inline constexpr double kGmresToleranceFactor = 1e-2;
/// Tolerance of an iterative solver as preconditioner.
inline constexpr double kPreconditionerTolerance = 1e-2;
/// Largest relative residual of GMRES with which its direction is tried.
inline constexpr double kMaxGmresResidual = 0.1;
/// Max number of trials along the direction of GMRES, before the direction of K alone.
inline constexpr int kNonsymmetricTrials = 4;

// Stagnation.

/// A decrease of the energy counts if it exceeds this multiple of the round-off ...
inline constexpr double kRoundOffMultiple = 10.0;
/// ... and, after a step with a shift, this fraction of the decrease so far (test
/// ShiftedStepsWithLittleProgressStagnate).
inline constexpr double kShiftedGainFraction = 1e-3;
/// A decrease of |r| counts if |r| falls below this multiple of its previous minimum.
inline constexpr double kResidualReduction = 0.9;

// Convergence by round-off.

/// A start whose |r| exceeds this fraction of the residual reference is not accepted as round-off,
/// unless NewtonOptions::may_accept_start_by_round_off, or no step from the start is acceptable.
inline constexpr double kMaxRoundOffFraction = 1e-3;

// Linear tolerance (\cite eisenstat1996, choice 2).

/// The tolerance is not less than this fraction of what convergence needs.
inline constexpr double kOversolvingFraction = 0.1;

}  // namespace lefort::fem::internal
