// RigidDescent: the energy of the rigid step as a function of the shape alone, with the rotations
// that fit it best, and its first and second derivatives. For cells that measure the edges they fit
// (FACE cells and welds), so that turning with the shape never costs them anything.
//
//     E(v)  = Σ w |(v_b − v_a) − t̂ e|²
//     −½∇E  = Σ w (t̂ e − (v_b − v_a))    at b, against it at a
//     ½E''  = dᴴ L d − Σ_c Im(conj(t̂_c) s_c)² / |S_c|    along d, L the rigid matrix
//
// where S = Σ w conj(e)(v_b − v_a) of a cell, t̂ = S/|S|, and s is the same of d.
#pragma once

#include <vector>

#include "core/base/wide.h"
#include "core/energy/cells.h"
#include "core/energy/local_step.h"

namespace arap {

// One object per job. Not thread-safe. Plain and wide machine code give the same bytes.
class RigidDescent {
 public:
  // Refers to `cells`, which have no hinges. `wide`: with the wide machine code of the kernels.
  explicit RigidDescent(const Cells& cells, bool wide = HasWide());

  // The energy of `v`. `pull` (#V each) becomes −½∇E. Keeps the rotations for Bend. O(#F).
  double Pull(ConstShapeView v, ShapeView pull, std::size_t vertices);

  // By how much the cells' turning lessens the curvature dᴴ L d at the shape of the last Pull.
  double Bend(ConstShapeView d) const;

 private:
  double PullStars(ConstShapeView v, ShapeView pull);
  double BendStars(ConstShapeView d) const;

  const Cells& cells_;
  const bool wide_;
  // Of faces and stars: the rotation, and 1/|S| or 0 where there is no direction.
  std::vector<double> face_x_, face_y_, face_inverse_;
  std::vector<double> star_x_, star_y_, star_inverse_;
};

}  // namespace arap
