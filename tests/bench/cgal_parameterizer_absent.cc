#include <cstdlib>

#include "tests/bench/cgal_parameterizer.h"

namespace arap::bench {

struct CgalParameterizer::Data {};

bool CgalParameterizer::Available() { return false; }
CgalParameterizer::CgalParameterizer(const SurfaceMesh&) { std::abort(); }
CgalParameterizer::~CgalParameterizer() = default;
std::string CgalParameterizer::Run(CgalMethod) { return "not there"; }
std::vector<Complex> CgalParameterizer::uv() const { return {}; }

}  // namespace arap::bench
