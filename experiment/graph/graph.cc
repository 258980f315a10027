#include "experiment/graph/graph.h"

#include <algorithm>
#include <cassert>
#include <complex>

#include "base/linear_algebra.h"

namespace mascot {
namespace {

/// Strongly connected components by Tarjan's algorithm (SIAM J. Computing 1(2), 1972), without recursion: a path of ten
/// thousand agents would overflow the stack.
class Tarjan {
 public:
  explicit Tarjan(const Graph& graph) : graph_(graph), visits_(static_cast<std::size_t>(graph.size()) + 1) {
    for (int id = 1; id <= graph.size(); ++id)
      if (visits_[Index(id)].order == 0) Explore(id);
  }

  std::vector<std::vector<int>> components;

 private:
  struct Visit {
    int order = 0;  ///< number in the order of finding, from 1; 0: not found yet
    int low = 0;    ///< smallest order among the agents on the stack that it reaches
    bool on_stack = false;
    std::size_t next = 0;  ///< neighbour to look at next
  };

  static std::size_t Index(int id) { return static_cast<std::size_t>(id); }

  void Explore(int start) {
    std::vector<int> trail;
    Enter(start, trail);
    while (!trail.empty()) {
      const int id = trail.back();
      Visit& visit = visits_[Index(id)];
      const auto& heard = graph_.HeardBy(id);
      if (visit.next < heard.size()) {
        const int j = heard[visit.next++].id;
        if (visits_[Index(j)].order == 0)
          Enter(j, trail);
        else if (visits_[Index(j)].on_stack)
          visit.low = std::min(visit.low, visits_[Index(j)].order);
      } else {
        trail.pop_back();
        if (!trail.empty()) visits_[Index(trail.back())].low = std::min(visits_[Index(trail.back())].low, visit.low);
        if (visit.low == visit.order) TakeComponent(id);
      }
    }
  }

  void Enter(int id, std::vector<int>& trail) {
    ++found_;
    visits_[Index(id)] = {found_, found_, true, 0};
    stack_.push_back(id);
    trail.push_back(id);
  }

  void TakeComponent(int first) {
    std::vector<int> component;
    do {
      component.push_back(stack_.back());
      visits_[Index(stack_.back())].on_stack = false;
      stack_.pop_back();
    } while (component.back() != first);
    std::sort(component.begin(), component.end());
    components.push_back(std::move(component));
  }

  const Graph& graph_;
  std::vector<Visit> visits_;
  std::vector<int> stack_;
  int found_ = 0;
};

}  // namespace

Graph::Graph(std::vector<std::vector<Neighbour>> heard)
    : heard_(std::make_shared<const std::vector<std::vector<Neighbour>>>(std::move(heard))) {
  for ([[maybe_unused]] const auto& row : *heard_)
    assert(std::is_sorted(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.id < b.id; }));
}

bool Graph::Hears(int hearer, int heard) const {
  if (hearer < 1 || hearer > size()) return false;
  const auto& neighbours = HeardBy(hearer);
  const auto edge = std::ranges::lower_bound(neighbours, heard, {}, &Neighbour::id);
  return edge != neighbours.end() && edge->id == heard;
}

std::size_t Graph::edges() const {
  std::size_t count = 0;
  for (const auto& row : *heard_) count += row.size();
  return count;
}

bool Graph::IsSymmetric() const {
  for (int i = 1; i <= size(); ++i) {
    for (const Neighbour& j : HeardBy(i)) {
      const auto& row = HeardBy(j.id);
      const auto back =
          std::lower_bound(row.begin(), row.end(), i, [](const Neighbour& n, int id) { return n.id < id; });
      if (back == row.end() || back->id != i || back->weight != j.weight) return false;
    }
  }
  return true;
}

Eigen::MatrixXd Graph::Laplacian() const {
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(size(), size());
  for (int i = 1; i <= size(); ++i) {
    for (const Neighbour& j : HeardBy(i)) {
      laplacian(i - 1, j.id - 1) = -j.weight;
      laplacian(i - 1, i - 1) += j.weight;
    }
  }
  return laplacian;
}

// With agents ordered by components, so that each component hears only those before it, L is block triangular, and its
// eigenvalues are those of the diagonal blocks. Each block by itself gives accurate values for eigenvalues that several
// blocks share: in a long directed path all but one are 1, which no solver finds from the whole matrix.
Eigen::VectorXcd Graph::Eigenvalues() const {
  const Eigen::MatrixXd laplacian = Laplacian();
  const bool symmetric = IsSymmetric();
  Eigen::VectorXcd values(size());
  Eigen::Index found = 0;
  for (const std::vector<int>& component : Components()) {
    std::vector<Eigen::Index> places;
    for (const int id : component) places.push_back(id - 1);
    const Eigen::MatrixXd block = laplacian(places, places);
    auto some = values.segment(found, block.rows());
    if (symmetric)
      some = SymmetricEigenvalues(block).cast<std::complex<double>>();
    else
      some = mascot::Eigenvalues(block);
    found += block.rows();
  }
  std::sort(values.begin(), values.end(), [](const auto& a, const auto& b) {
    return a.real() != b.real() ? a.real() < b.real() : a.imag() < b.imag();
  });
  return values;
}

// Without a spanning tree, 0 is an eigenvalue twice; a numerical solver would miss that by a rounding error.
double Graph::Lambda2() const { return size() < 2 || Roots().empty() ? 0 : Eigenvalues()(1).real(); }

// The left null vector gamma is zero outside the roots, which hear only each other. On the roots it solves gamma' L = 0
// with their own Laplacian L; one of these equations follows from the others and is replaced by sum(gamma) = 1.
std::optional<Eigen::VectorXd> Graph::LeftNullVector() const {
  const std::vector<int> roots = Roots();
  if (roots.empty()) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(roots.size());
  Eigen::MatrixXd transposed = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (const Neighbour& neighbour : HeardBy(roots[static_cast<std::size_t>(i)])) {
      const Eigen::Index j = std::lower_bound(roots.begin(), roots.end(), neighbour.id) - roots.begin();
      transposed(j, i) -= neighbour.weight;
      transposed(i, i) += neighbour.weight;
    }
  }
  transposed.row(0).setOnes();
  const Eigen::VectorXd weights = Solve(transposed, Eigen::VectorXd::Unit(count, 0));
  Eigen::VectorXd gamma = Eigen::VectorXd::Zero(size());
  for (Eigen::Index i = 0; i < count; ++i) gamma(roots[static_cast<std::size_t>(i)] - 1) = weights(i);
  return gamma;
}

std::vector<std::vector<int>> Graph::Components() const {
  std::vector<std::vector<int>> components = Tarjan(*this).components;
  std::sort(components.begin(), components.end());
  return components;
}

// If some agent reaches all others, the agents that do are one component, and no agent in it hears one outside.
std::vector<int> Graph::Roots() const {
  for (const std::vector<int>& component : Components()) {
    const bool closed = std::all_of(component.begin(), component.end(), [&](int id) {
      return std::all_of(HeardBy(id).begin(), HeardBy(id).end(), [&](const Neighbour& j) {
        return std::binary_search(component.begin(), component.end(), j.id);
      });
    });
    if (!closed) continue;
    return SpanningTree(component.front()) ? component : std::vector<int>{};
  }
  return {};
}

std::optional<std::vector<int>> Graph::SpanningTree(int root) const {
  std::vector<std::vector<int>> listeners(static_cast<std::size_t>(size()));
  for (int i = 1; i <= size(); ++i)
    for (const Neighbour& j : HeardBy(i)) listeners[static_cast<std::size_t>(j.id - 1)].push_back(i);

  constexpr int kNobody = -1;
  std::vector<int> parent(static_cast<std::size_t>(size()), kNobody);
  parent[static_cast<std::size_t>(root - 1)] = 0;
  std::vector<int> level{root};
  std::size_t reached = 1;
  while (!level.empty()) {
    std::vector<int> next;
    for (const int j : level) {  // in increasing id, so that the lowest id one level up is the parent
      for (const int i : listeners[static_cast<std::size_t>(j - 1)]) {
        int& parent_of_i = parent[static_cast<std::size_t>(i - 1)];
        if (parent_of_i != kNobody) continue;
        parent_of_i = j;
        next.push_back(i);
      }
    }
    reached += next.size();
    std::sort(next.begin(), next.end());
    level = std::move(next);
  }
  if (reached < parent.size()) return std::nullopt;
  return parent;
}

}  // namespace mascot
