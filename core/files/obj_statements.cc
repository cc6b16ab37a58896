#include "core/files/obj_statements.h"

#include <algorithm>
#include <array>

namespace arap {
namespace {

// Vertices, their attributes and faces, which may share a line.
bool IsGeometry(std::string_view word) {
  return word == "v" || word == "f" || word == "vt" || word == "vn";
}
bool IsGeometry(ObjKeyword keyword) { return keyword <= ObjKeyword::kFace; }

// Names of files, materials and parts, which may end with a backslash.
bool IsName(std::string_view word) {
  constexpr std::array<std::string_view, 6> kWords{"o",      "g",      "mtllib",
                                                   "usemtl", "maplib", "usemap"};
  return std::find(kWords.begin(), kWords.end(), word) != kWords.end();
}

ObjKeyword KeywordOf(std::string_view word) {
  if (word == "v") return ObjKeyword::kVertex;
  if (word == "f" || word == "fo") return ObjKeyword::kFace;
  if (word == "vt") return ObjKeyword::kTexture;
  if (word == "vn") return ObjKeyword::kNormal;
  if (word == "l") return ObjKeyword::kLine;
  if (word == "o") return ObjKeyword::kObject;
  if (word == "g") return ObjKeyword::kGroup;
  constexpr std::array<std::string_view, 9> kOthers{
      "s", "p", "mg", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj"};
  const bool known =
      IsName(word) || std::find(kOthers.begin(), kOthers.end(), word) != kOthers.end();
  return known ? ObjKeyword::kOther : ObjKeyword::kUnknown;
}

}  // namespace

void ObjStatements::Begin(std::string_view word) {
  word_ = word;
  keyword_ = KeywordOf(word);
  at_ = scanner_.at();
  begin_ = at_ - word.size();
}

bool ObjStatements::Next() {
  if (started_) {
    while (!Argument().empty()) {
    }
    if (!pending_.empty()) {
      Begin(pending_);
      leads_line_ = false;
      pending_ = {};
      return true;
    }
    if (!scanner_.NextLine()) return false;
  }
  started_ = true;
  for (;;) {
    line_begin_ = scanner_.at();
    const std::string_view word = scanner_.Word(/*continued=*/true);
    if (!word.empty()) {
      Begin(word);
      leads_line_ = true;
      return true;
    }
    if (!scanner_.NextLine()) return false;
  }
}

std::string_view ObjStatements::Argument() {
  if (!pending_.empty()) return {};
  const std::string_view word = scanner_.Word(!IsName(word_));
  if (IsGeometry(keyword_) && IsGeometry(word)) {
    pending_ = word;
    return {};
  }
  if (!word.empty()) at_ = scanner_.at();
  return word;
}

}  // namespace arap
