#include "core/energy/cells.h"

namespace arap {
namespace {

template <class... Columns>
std::size_t BytesOf(const Columns&... columns) {
  return ((columns.capacity() * sizeof(columns[0])) + ...);
}

}  // namespace

void HingeTable::Add(std::uint32_t from, std::uint32_t to, std::uint32_t left_vertex,
                     std::uint32_t right_vertex, Complex to_j, Complex to_left, Complex to_right,
                     double w) {
  i.push_back(static_cast<std::int32_t>(from));
  j.push_back(static_cast<std::int32_t>(to));
  left.push_back(static_cast<std::int32_t>(left_vertex));
  right.push_back(static_cast<std::int32_t>(right_vertex));
  along_x.push_back(to_j.real());
  along_y.push_back(to_j.imag());
  left_x.push_back(to_left.real());
  left_y.push_back(to_left.imag());
  right_x.push_back(to_right.real());
  right_y.push_back(to_right.imag());
  weight.push_back(w);
}

void FaceTable::Add(const Triangle& triangle, Complex to_1, Complex to_2, const double (&w)[3]) {
  v0.push_back(static_cast<std::int32_t>(triangle[0]));
  v1.push_back(static_cast<std::int32_t>(triangle[1]));
  v2.push_back(static_cast<std::int32_t>(triangle[2]));
  e1_x.push_back(to_1.real());
  e1_y.push_back(to_1.imag());
  e2_x.push_back(to_2.real());
  e2_y.push_back(to_2.imag());
  weight0.push_back(w[0]);
  weight1.push_back(w[1]);
  weight2.push_back(w[2]);
}

void StarTable::Add(std::span<const Spoke> star) {
  double sum = 0;
  for (const Spoke& s : star) sum += s.weight * std::norm(s.rest);
  spokes.insert(spokes.end(), star.begin(), star.end());
  begin.push_back(static_cast<std::uint32_t>(spokes.size()));
  size_of.push_back(sum);
}

std::size_t Cells::bytes() const {
  const HingeTable& h = hinges;
  const FaceTable& f = faces;
  const StarTable& s = stars;
  return BytesOf(h.i, h.j, h.left, h.right, h.along_x, h.along_y, h.left_x, h.left_y, h.right_x,
                 h.right_y, h.weight, h.runs) +
         BytesOf(f.v0, f.v1, f.v2, f.e1_x, f.e1_y, f.e2_x, f.e2_y, f.weight0, f.weight1, f.weight2,
                 f.runs) +
         BytesOf(s.begin, s.spokes, s.size_of, s.runs);
}

}  // namespace arap
