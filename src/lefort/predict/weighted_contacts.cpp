#include <lefort/contact/contact_surface.h>
#include <lefort/predict/tissue_boundary.h>
#include <lefort/predict/weighted_contacts.h>

#include <algorithm>
#include <utility>

namespace lefort::predict {

void WeightedContacts::add_segments(const mesh::VolumeMesh& tissue,
                                    std::vector<contact::RigidObstacle> segments,
                                    const contact::WeightedContactTerm::Options& options) {
  tissue_ = &tissue;
  on_segments.emplace(tissue.nodes_L, tissue.face_sets.at(sets::kContact), std::move(segments),
                      options);
}

void WeightedContacts::add_stationary(const mesh::VolumeMesh& tissue,
                                      const std::vector<mesh::Face>& faces,
                                      const contact::RigidObstacle& bone,
                                      const contact::WeightedContactTerm::Options& options) {
  tissue_ = &tissue;
  on_stationary.emplace(tissue.nodes_L, faces, std::vector{bone}, options);
}

std::vector<const contact::WeightedContactTerm*> WeightedContacts::terms() const {
  std::vector<const contact::WeightedContactTerm*> terms;
  for (const auto* term : {&on_segments, &on_stationary})
    if (*term) terms.push_back(&**term);
  return terms;
}

void WeightedContacts::set_poses(const std::vector<RigidTransform>& X_LB) {
  for (std::size_t k = 0; on_segments && k < X_LB.size(); ++k) on_segments->set_pose(k, X_LB[k]);
}

double WeightedContacts::max_step_length(const VectorX& u, const VectorX& du) const {
  const std::vector<Vec3> x_L = contact::displaced(tissue_->nodes_L, u);
  const std::vector<Vec3> dx_L =
      contact::displaced(std::vector<Vec3>(x_L.size(), Vec3::Zero()), du);
  double length = 1.0;
  for (const contact::WeightedContactTerm* term : terms())
    length = std::min(length, term->max_step_length(x_L, dx_L));
  return length;
}

bool WeightedContacts::allows_motion(const std::vector<RigidTransform>& from_X_LB,
                                     const std::vector<Vec3>& last_L, const VectorX& to) const {
  const std::vector<Vec3> to_L = contact::displaced(tissue_->nodes_L, to);
  const std::vector<RigidTransform> at_rest{RigidTransform::Identity()};
  return !(on_segments && on_segments->max_motion(last_L, from_X_LB, to_L) < 1.0) &&
         !(on_stationary && on_stationary->max_motion(last_L, at_rest, to_L) < 1.0);
}

VectorX WeightedContacts::moved_with_bones(const std::vector<RigidTransform>& from_X_LB,
                                           const std::vector<Vec3>& last_L,
                                           const VectorX& to) const {
  std::vector<Vec3> x_L = contact::displaced(tissue_->nodes_L, to);
  if (on_segments) x_L = on_segments->moved_with_bones(last_L, from_X_LB, std::move(x_L));
  VectorX u(3 * Index(x_L.size()));
  for (std::size_t n = 0; n < x_L.size(); ++n)
    u.segment<3>(3 * Index(n)) = x_L[n] - tissue_->nodes_L[n];
  return u;
}

fem::NewtonOutcome WeightedContacts::solve(const std::vector<RigidTransform>& from_X_LB,
                                           const VectorX& u_last,
                                           const std::vector<RigidTransform>& X_LB,
                                           const VectorX& start, int max_iterations,
                                           const contact::SolveFrom& solve) {
  const std::vector<Vec3> last_L = contact::displaced(tissue_->nodes_L, u_last);
  VectorX from = start;
  if (!allows_motion(from_X_LB, last_L, from)) {
    from = moved_with_bones(from_X_LB, last_L, from);
    if (!allows_motion(from_X_LB, last_L, from)) {
      fem::NewtonOutcome outcome;
      outcome.x = start;
      outcome.reason = "a bone would pass through tissue in one increment";
      return outcome;
    }
  }
  set_poses(from_X_LB);
  std::vector<contact::WeightedContactTerm*> terms;
  std::vector<contact::ActiveSet> active;
  for (auto* term : {&on_segments, &on_stationary}) {
    if (!*term) continue;
    (*term)->note_clearances(last_L);
    active.push_back((*term)->active_set(last_L));
    terms.push_back(&**term);
  }
  set_poses(X_LB);
  return contact::solve_active_set(terms, tissue_->nodes_L, std::move(active), from, max_iterations,
                                   solve);
}

}  // namespace lefort::predict
