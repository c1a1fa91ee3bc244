#include <lefort/core/check.h>
#include <lefort/fem/elements/gradient_products.h>

#include <array>

namespace lefort::fem {

void multiply_columns(const Mat3& M, const double* columns, int nodes, double* product) {
  for (int a = 0; a < nodes; ++a, columns += 3, product += 3) {
    for (int i = 0; i < 2; ++i)
      product[i] = M(i, 0) * columns[0] + M(i, 1) * columns[1] + M(i, 2) * columns[2];
    product[2] = M(2, 0) * columns[0] + (M(2, 1) * columns[1] + M(2, 2) * columns[2]);
  }
}

void multiply_columns_transposed(const Mat3& M, const double* columns, int nodes, double* product) {
  for (int a = 0; a < nodes; ++a, columns += 3, product += 3)
    for (int i = 0; i < 3; ++i)
      product[i] = M(0, i) * columns[0] + M(1, i) * columns[1] + M(2, i) * columns[2];
}

void add_point_stiffness(const Mat9& A, double dV, const double* shape_gradients, int nodes,
                         double* K) {
  const Index size = 3 * Index(nodes);
  for (int b = 0; b < nodes; ++b) {
    const double* N_b = shape_gradients + Index(3) * b;
    const std::array<double, 3> g_b{dV * N_b[0], dV * N_b[1], dV * N_b[2]};
    std::array<std::array<double, 9>, 3> dP;  // Column j: of the displacement along axis j.
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 9; ++i)
        dP[std::size_t(j)][std::size_t(i)] =
            g_b[0] * A(i, j) + g_b[1] * A(i, 3 + j) + g_b[2] * A(i, 6 + j);
    for (int a = b; a < nodes; ++a) {
      const double* g_a = shape_gradients + Index(3) * a;
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
          const double* dP_i = dP[std::size_t(j)].data() + i;
          const double K_ij = g_a[0] * dP_i[0] + g_a[1] * dP_i[3] + g_a[2] * dP_i[6];
          K[(3 * b + j) * size + 3 * a + i] += K_ij;
          if (a != b) K[(3 * a + i) * size + 3 * b + j] += K_ij;
        }
    }
  }
}

void add_low_rank_product(const double* a, const double* b, int size, int rank, double* K) {
  constexpr int kMaxSize = 60;  // 20 nodes.
  LEFORT_ASSERT(size <= kMaxSize);
  std::array<double, kMaxSize> column;
  for (int j = 0; j < size; ++j, K += size) {
    for (int i = 0; i < size; ++i) column[std::size_t(i)] = a[i] * b[j];
    for (int m = 1; m < rank; ++m)
      for (int i = 0; i < size; ++i) column[std::size_t(i)] += a[m * size + i] * b[m * size + j];
    for (int i = 0; i < size; ++i) K[i] += column[std::size_t(i)];
  }
}

}  // namespace lefort::fem
