#include "forcefield/ewald/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/shares.hpp"
#include "forcefield/ewald/fourier.hpp"
#include "forcefield/ewald/mesh_kernels.hpp"
#include "md/step_parts.hpp"

namespace taut {

class PmeMesh::Engine {
 public:
  virtual ~Engine() = default;
  virtual void set_box(const Box& box) = 0;
  virtual double add_forces(const Vectors& x, Vectors& f) = 0;
  virtual Eigen::Matrix3d virial(const Vectors& x) = 0;
};

namespace {

constexpr int kAtomsPerThread = 200;    // fewer are not worth a thread
constexpr int kPointsPerThread = 2000;  // the same of the influence function
constexpr int kStrip = 8;               // rows of a plane whose atoms follow each other

// M_n(k + 1), k = 0 … n − 1 (mesh_kernels.hpp)
std::array<double, kMostOrder> splines_on_a_point(int order) {
  std::array<double, kMostOrder> value{1};
  for (int n = 3; n <= order; ++n)
    for (int k = n - 1; k >= 0; --k)
      value[k] = ((k > 0 ? (n - 1 - k) * value[k - 1] : 0.0) + (k + 1) * value[k]) / (n - 1);
  return value;
}

// |b(m)|⁻² = |Σ_k M_n(k + 1) e^(2πimk/size)|² (eq. 4.4), m = 0 … size − 1. Where it is zero, at size/2 of odd
// orders, the mean of its neighbours, as OpenMM has it.
std::vector<double> spline_moduli(int order, int size) {
  const auto weight = splines_on_a_point(order);
  std::vector<double> moduli(size);
  for (int m = 0; m < size; ++m) {
    std::complex<double> sum = 0;
    for (int k = 0; k < order; ++k)
      sum += weight[k] * std::polar(1.0, 2 * std::numbers::pi * double(long(m) * k % size) / size);
    moduli[m] = std::norm(sum);
  }
  for (int m = 0; m < size; ++m)
    if (moduli[m] < 1e-7) moduli[m] = (moduli[(m + size - 1) % size] + moduli[(m + 1) % size]) / 2;
  return moduli;
}

double square(double a) {
  return a * a;
}

template <class T>
class MeshIn final : public PmeMesh::Engine {
  // By k along an axis: m², and exp(−π²m²/α²)|b(m)|².
  struct Axis {
    std::vector<double> m2, factor;
  };

 public:
  MeshIn(const Eigen::VectorXd& charge, const PmeParameters& p)
      : order_(p.order),
        alpha_(p.alpha),
        size_(p.grid),
        strips_((size_[1] + kStrip - 1) / kStrip),
        grid_(p.grid, padded_order(p.order)) {
    for (int a = 0; a < charge.size(); ++a)
      if (charge[a] != 0) charged_.push_back({a, charge[a]});
    found_.resize(charged_.size());
    atoms_.resize(charged_.size());
    begin_.resize(size_[0] + 1);
    for (int d = 0; d < 3; ++d) {
      moduli_[d] = spline_moduli(order_, size_[d]);
      axis_[d].m2.resize(size_[d]);
      axis_[d].factor.resize(size_[d]);
    }
    influence_.resize(grid_.half() * of_row());
    energy_of_.resize(grid_.half());
    virial_of_.resize(grid_.half());
  }

  void set_box(const Box& box) override {
    box_ = box;
    for (int d = 0; d < 3; ++d) {
      to_fractional_.col(d) = box_.fractional(Vec3::Unit(d));
      grid_gradient_.col(d) = box_.reciprocal(size_[d] * Vec3::Unit(d));
    }
    const bool skewed = !box_.tilt.isZero(0);
    if (!skewed)
      for (int d = 0; d < 3; ++d) compute_waves_along(d);
    by_rows(threads_for(static_cast<long>(influence_.size()), kPointsPerThread),
            [&](int row, int) { skewed ? compute_skewed_influence(row) : compute_influence(row); });
  }

  double add_forces(const Vectors& x, Vectors& f) override {
    const int n = static_cast<int>(charged_.size()), threads = this->threads();
    in_part(StepPart::kMeshSpread, [&] { spread_and_transform(x, threads); });
    in_part(StepPart::kMeshSolve, [&] { solve_on_grid(threads); });
    in_part(StepPart::kMeshGather, [&] {
      in_parallel(threads, [&](int t) {
        const Share share(n, t, threads);
        add_mesh_forces<T>(mesh(), {atoms_.data() + share.begin, atoms_.data() + share.end}, grid_gradient_,
                           f);
      });
    });
    return std::accumulate(energy_of_.begin(), energy_of_.end(), 0.0);
  }

  // From transformed planes of charges to the potential.
  void solve_on_grid(int threads) {
    by_rows(threads, [&](int row, int t) {
      energy_of_[row] = share_of(row) * solve(influence_of(row), grid_.transform_row(row, t));
      grid_.transform_row_back(row, t);
    });
    in_parallel(threads, [&](int t) {
      const Share share(size_[0], t, threads);
      for (int plane = share.begin; plane < share.end; ++plane) {
        grid_.transform_plane_back(plane, t);
        copy_row_starts(plane);
      }
    });
  }

  Eigen::Matrix3d virial(const Vectors& x) override {
    const int threads = this->threads();
    spread_and_transform(x, threads);
    by_rows(threads, [&](int row, int t) { virial_of_[row] = virial_of(row, grid_.transform_row(row, t)); });
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Eigen::Matrix3d& of_row : virial_of_) sum += of_row;
    return sum;
  }

 private:
  int threads() const { return threads_for(static_cast<long>(charged_.size()), kAtomsPerThread); }

  void by_rows(int threads, const auto& work) {
    in_parallel(threads, [&](int t) {
      const Share share(grid_.half(), t, threads);
      for (int row = share.begin; row < share.end; ++row) work(row, t);
    });
  }

  // Spreads the charges to the grid and transforms each plane.
  void spread_and_transform(const Vectors& x, int threads) {
    const int n = static_cast<int>(charged_.size());
    grid_.make_room(threads);
    count_.resize(std::size_t(threads) * buckets());
    next_.resize(count_.size());
    in_parallel(threads, [&](int t) { find_and_count(x, Share(n, t, threads), count_of(t)); });
    in_parallel(threads, [&](int t) {
      const Share share(n, t, threads);
      find_places(t, threads);
      for (int c = share.begin; c < share.end; ++c) atoms_[next_of(t)[bucket(found_[c])]++] = found_[c];
    });
    in_parallel(threads, [&](int t) { spread(Share(size_[0], t, threads), t); });
  }

  // Atoms are sorted by plane and, within one, by strip: grid points of consecutive atoms stay in cache.
  int buckets() const { return size_[0] * strips_; }
  int bucket(const MeshAtom<T>& atom) const { return atom.point[0] * strips_ + atom.point[1] / kStrip; }
  int* count_of(int thread) { return count_.data() + std::ptrdiff_t{thread} * buckets(); }
  int* next_of(int thread) { return next_.data() + std::ptrdiff_t{thread} * buckets(); }

  void find_and_count(const Vectors& x, const Share& share, int* count) {
    find_points<T>({size_, to_fractional_}, x,
                   std::span(charged_).subspan(share.begin, share.end - share.begin),
                   found_.data() + share.begin);
    std::fill_n(count, buckets(), 0);
    for (int c = share.begin; c < share.end; ++c) ++count[bucket(found_[c])];
  }

  // Finds where in atoms_ thread t's first atom of each bucket belongs: after those of the threads before it.
  void find_places(int t, int threads) {
    int begin = 0;
    for (int b = 0; b < buckets(); ++b) {
      if (t == 0 && b % strips_ == 0) begin_[b / strips_] = begin;
      for (int u = 0; u < threads; ++u) {
        if (u == t) next_of(t)[b] = begin;
        begin += count_of(u)[b];
      }
    }
    if (t == 0) begin_[size_[0]] = begin;
  }

  // Spreads all charges to these planes: those of the atoms in planes near enough below, the lowest first. A
  // plane is transformed when it has all its charges.
  void spread(const Share& planes, int thread) {
    for (int below = planes.begin - order_ + 1; below < planes.end; ++below) {
      if (const int next = below + order_ - 1; next < planes.end)
        std::fill_n(grid_.plane(next), grid_.apart(), T(0));
      const int plane = (below % size_[0] + size_[0]) % size_[0];
      spread_charges<T>(mesh(),
                        {std::max(planes.begin - below, 0), std::min(planes.end - 1 - below, order_ - 1)},
                        {atoms_.data() + begin_[plane], atoms_.data() + begin_[plane + 1]});
      if (below < planes.begin) continue;
      wrap_spread_ends(below);
      grid_.transform_plane(below, thread);
    }
  }

  T* row(int plane, int k2) { return grid_.plane(plane) + std::ptrdiff_t{k2} * grid_.stride(); }

  // Adds charges spread beyond the last row, and beyond the last point of a row, to the first ones: the grid
  // is periodic.
  void wrap_spread_ends(int plane) {
    for (int k2 = 0; k2 < order_ - 1; ++k2)
      std::transform(row(plane, k2), row(plane, k2 + 1), row(plane, size_[1] + k2), row(plane, k2),
                     std::plus());
    for (int k2 = 0; k2 < size_[1]; ++k2)
      for (int k3 = 0; k3 < order_ - 1; ++k3) row(plane, k2)[k3] += row(plane, k2)[size_[2] + k3];
  }

  // The wave vector m of a point of the transforms [1/nm]. In the middle of an even edge +K/2 and −K/2 are
  // the same wave of the grid: `middle`, 1 or −1, chooses. The sum over all points has one of them at k and
  // the other at −k, where |F|² is the same; so each counts for half. They differ in m² where the box is
  // skewed.
  Vec3 wave(int k1, int k2, int k3, int middle = 1) const {
    const auto whole = [&](int d, int k) {
      return double(2 * k == size_[d] ? middle * k : 2 * k < size_[d] ? k : k - size_[d]);
    };
    return box_.reciprocal({whole(0, k1), whole(1, k2), whole(2, k3)});
  }
  bool in_a_middle(int k1, int k2, int k3) const {
    return 2 * k1 == size_[0] || 2 * k2 == size_[1] || 2 * k3 == size_[2];
  }
  double share_of(int k2) const { return k2 == 0 || 2 * k2 == size_[1] ? 0.5 : 1; }  // ½, and m₂'s other half

  // Computes G = exp(−π²m²/α²)/(πVm²) |b|² for a row of every plane, in the order of the transforms. In a
  // rectangular box m² is a sum over the axes, and the rest of G a product.
  void compute_influence(int row) {
    const auto& [x, y, z] = axis_;
    T* g = influence_.data() + row * of_row();
    for (int k3 = 0; k3 < size_[2]; ++k3) {
      const double m2 = y.m2[row] + z.m2[k3],
                   factor = y.factor[row] * z.factor[k3] / (std::numbers::pi * box_.volume());
      for (int k1 = 0; k1 < size_[0]; ++k1) *g++ = static_cast<T>(factor * x.factor[k1] / (x.m2[k1] + m2));
    }
    if (row == 0) influence_[0] = 0;
  }

  void compute_waves_along(int d) {
    for (int k = 0; k < size_[d]; ++k) {
      const double m = std::min(k, size_[d] - k) / box_.edge[d];
      axis_[d].m2[k] = m * m;
      axis_[d].factor[k] = std::exp(-square(std::numbers::pi / alpha_ * m)) / moduli_[d][k];
    }
  }

  void compute_skewed_influence(int row) {
    const double pi = std::numbers::pi, inv = pi * pi / (alpha_ * alpha_);
    for (int k1 = 0; k1 < size_[0]; ++k1) {
      const double factor = pi * box_.volume() * moduli_[0][k1] * moduli_[1][row];
      T* const g = influence_.data() + row * of_row() + k1;
      for (int k3 = 0; k3 < size_[2]; ++k3) {
        const auto influence = [&](double m2) {
          return m2 > 0 ? std::exp(-inv * m2) / (factor * moduli_[2][k3] * m2) : 0.0;
        };
        double G = influence(wave(k1, row, k3).squaredNorm());
        if (in_a_middle(k1, row, k3)) G = (G + influence(wave(k1, row, k3, -1).squaredNorm())) / 2;
        g[std::ptrdiff_t{k3} * size_[0]] = static_cast<T>(G);
      }
    }
  }
  std::ptrdiff_t of_row() const { return std::ptrdiff_t{size_[0]} * size_[2]; }
  std::span<const T> influence_of(int row) const {
    return std::span(influence_).subspan(row * of_row(), of_row());
  }

  Eigen::Matrix3d virial_of(int row, const std::complex<T>* z) const {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    const T* g = influence_of(row).data();
    for (int k3 = 0; k3 < size_[2]; ++k3)
      for (int k1 = 0; k1 < size_[0]; ++k1, ++g, ++z) {
        const Vec3 m = wave(k1, row, k3);
        if (m.isZero(0)) continue;
        const double part = share_of(row) * double(*g) * std::norm(std::complex<double>(*z));
        sum.diagonal().array() += part;
        if (!in_a_middle(k1, row, k3)) {
          sum -= tensor(m, part);
          continue;
        }
        const Vec3 other = wave(k1, row, k3, -1);
        const double share = first_of_two_waves(m.squaredNorm(), other.squaredNorm());
        sum -= tensor(m, share * part) + tensor(other, (1 - share) * part);
      }
    return sum;
  }

  Eigen::Matrix3d tensor(const Vec3& m, double energy) const {
    return 2 * energy * (1 / m.squaredNorm() + square(std::numbers::pi / alpha_)) * m * m.transpose();
  }
  // The share of the first wave in the sum of two waves' G.
  double first_of_two_waves(double m2, double other2) const {
    if (m2 == other2) return 0.5;
    return 1 / (1 + std::exp(square(std::numbers::pi / alpha_) * (m2 - other2)) * m2 / other2);
  }

  // Copies the first rows, and the first points of each row, past the end so that gathering needs no wrap.
  void copy_row_starts(int plane) {
    for (int k2 = 0; k2 < size_[1]; ++k2)
      for (int k3 = 0; k3 < padded_order(order_); ++k3) row(plane, k2)[size_[2] + k3] = row(plane, k2)[k3];
    for (int k2 = 0; k2 < order_ - 1; ++k2)
      std::copy(row(plane, k2), row(plane, k2 + 1), row(plane, size_[1] + k2));
  }

  MeshGrid<T> mesh() { return {grid_.plane(0), size_, grid_.stride(), grid_.apart(), order_}; }

  int order_;
  double alpha_;  // [1/nm]
  std::array<int, 3> size_;
  int strips_;  // of a plane
  Box box_;
  Eigen::Matrix3d to_fractional_;  // makes shares of a, b and c of a place
  Eigen::Matrix3d grid_gradient_;  // columns ∇u of grid coordinates u along a, b and c [1/nm]
  FourierGrid<T> grid_;
  std::vector<Charged> charged_;
  std::vector<MeshAtom<T>> found_, atoms_;  // as charged_; by plane and strip
  std::vector<int> begin_;                  // of a plane's, in atoms_
  std::vector<int> count_, next_;  // of a bucket's: how many, and the next one's place; thread by thread
  std::array<std::vector<double>, 3> moduli_;
  std::array<Axis, 3> axis_;       // of a rectangular box
  std::vector<T> influence_;       // G, row by row k₂, as the transforms come [1/nm]
  std::vector<double> energy_of_;  // by row, as what follows
  std::vector<Eigen::Matrix3d> virial_of_;
};

}  // namespace

PmeMesh::PmeMesh(const Eigen::VectorXd& charge, const PmeParameters& parameters, Precision precision) {
  if (precision == Precision::kMixed)
    engine_ = std::make_unique<MeshIn<float>>(charge, parameters);
  else
    engine_ = std::make_unique<MeshIn<double>>(charge, parameters);
}
PmeMesh::~PmeMesh() = default;
PmeMesh::PmeMesh(PmeMesh&&) noexcept = default;
PmeMesh& PmeMesh::operator=(PmeMesh&&) noexcept = default;

void PmeMesh::set_box(const Box& box) {
  engine_->set_box(box);
}
double PmeMesh::add_forces(const Vectors& x, Vectors& f) {
  return engine_->add_forces(x, f);
}
Eigen::Matrix3d PmeMesh::virial(const Vectors& x) {
  return engine_->virial(x);
}

}  // namespace taut
