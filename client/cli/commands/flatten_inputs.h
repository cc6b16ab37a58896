// What flatten is told beside the surface: seams, pins, rigidity, grain lines.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/flatten.h"

namespace arap::cli {

// Texts count vertices from 1, as OBJ files do; JSON counts from 0, as reports do. `name` is what
// faults call the file, before the number of the line. All faults are kInvalidOption.

// Vertex pairs. A line of text is a path of two or more vertices, cut from each to the
// next; # begins a comment. JSON is [[a, b], …], [a, b, …] in pairs, or an object with such a list
// as "cut_edges": a report.
Result<std::vector<std::array<std::uint32_t, 2>>> ParseSeams(const std::string& text,
                                                             const std::string& name,
                                                             std::size_t vertex_count);

// A line per pin: vertex u v [weight], u and v in the units of the surface; # begins a comment.
Result<std::vector<UvPin>> ParsePins(const std::string& text, const std::string& name,
                                     std::size_t vertex_count);

// One number per triangle in the order of the file, above 0 and at most 1e6; 1 is neutral. Text has
// one on a line, # begins a comment; JSON is an array.
Result<std::vector<double>> ParseRigidity(const std::string& text, const std::string& name,
                                          std::size_t triangle_count);

// Where an entry of what was parsed stands, "NAME:3" or "NAME:3:14": an edge of seams, a pin, the
// rigidity of a triangle, each counted from 0. O(text).
std::string PlaceOfSeam(const std::string& text, const std::string& name, std::size_t edge);
std::string PlaceOfPin(const std::string& text, const std::string& name, std::size_t pin);
std::string PlaceOfRigidity(const std::string& text, const std::string& name, std::size_t triangle);
// What the text calls vertex 0: 1, in JSON 0.
std::uint32_t FirstVertexIn(const std::string& text);

// FROM,TO[,ANGLE] with vertices from 1 and degrees. Says so when it is something else.
Result<GrainLine> ParseGrain(const std::string& text);
// Whether both ends of the line are vertices of the surface.
Status CheckGrain(const GrainLine& line, std::size_t vertex_count);

}  // namespace arap::cli
