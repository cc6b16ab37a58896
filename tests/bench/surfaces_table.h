// Every way of ours on every surface of a directory: what the choice of defaults is made by.
#pragma once

#include <string>

namespace arap::bench {

// For each OBJ file, by name, a table of methods, anchors and refinements: ARAP energy as laid out
// and at the best size, flipped triangles, worst stretch and compression, milliseconds of processor
// time. Surfaces that are no disks are cut automatically. Then the geometric mean of each way over
// all surfaces, relative to the best of each surface. Aborts with a message when a file is no OBJ.
void PrintSurfacesTable(const std::string& directory);

}  // namespace arap::bench
