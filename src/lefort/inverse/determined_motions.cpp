#include <lefort/inverse/determined_motions.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace lefort::inverse {

std::vector<MotionDirection> determined_motions(const Eigen::MatrixXd& target_hessian) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(target_hessian);
  std::vector<MotionDirection> directions;
  for (Index n = target_hessian.rows() - 1; n >= 0; --n) {
    MotionDirection one{.direction = eigen.eigenvectors().col(n),
                        .face_mm = std::sqrt(std::max(eigen.eigenvalues()[n], 0.0))};
    Index largest = 0;
    one.direction.cwiseAbs().maxCoeff(&largest);
    if (one.direction[largest] < 0.0) one.direction *= -1.0;
    one.is_determined = one.face_mm >= kDetermined_mm;
    directions.push_back(std::move(one));
  }
  return directions;
}

}  // namespace lefort::inverse
