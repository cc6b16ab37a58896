#include "client/src/drawing_answers.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "client/src/answers.h"
#include "proto/convert/drawing.h"

namespace arap::client::internal {
namespace {

bool IsPage(std::string_view page) {
  constexpr std::size_t kLongest = 9;
  return page == "cover" ||
         (!page.empty() && page.size() <= kLongest &&
          std::all_of(page.begin(), page.end(), [](char c) { return c >= '0' && c <= '9'; }));
}

}  // namespace

Result<std::vector<Drawing>> DrawingsFromWire(const v1::FlattenResponse& response,
                                              const FlattenQuery& query) {
  std::vector<Drawing> drawings = convert::DrawingsFromWire(response);
  if (drawings.size() != query.drawings.size()) {
    return Fail(BadAnswer(fmt::format("The server answered {} drawings, not {}.", drawings.size(),
                                      query.drawings.size())));
  }
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    const DrawingOptions& options = query.drawings[i];
    const std::vector<DrawingFile>& files = drawings[i].files;
    const bool pages = options.format == DrawingFormat::kSvg && !options.paper.empty();
    const bool named = std::all_of(files.begin(), files.end(), [&](const DrawingFile& file) {
      return (pages ? IsPage(file.page) : file.page.empty()) && !file.bytes.empty();
    });
    if (named && (pages ? !files.empty() : files.size() == 1)) continue;
    return Fail(BadAnswer(fmt::format("The server answered drawing {} without its files.", i)));
  }
  return drawings;
}

}  // namespace arap::client::internal
