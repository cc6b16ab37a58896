#include "core/files/gltf_document.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/files/bytes.h"
#include "core/files/json_text.h"
#include "core/files/text_file.h"
#include "core/files/text_scan.h"

namespace arap {
namespace {

constexpr std::string_view kGlbMagic = "glTF";
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr double kMostWhole = 9007199254740992;  // 2^53
constexpr std::size_t kJsonPerByte = 6;          // meshes that nodes repeat take ten more

// The value of a digit of base 64; 64 for what is none.
std::uint32_t Base64Digit(char c) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  return static_cast<std::uint32_t>(std::min(kDigits.find(c), kDigits.size()));
}

std::optional<std::string> FromBase64(std::string_view text) {
  for (int k = 0; k < 2 && text.ends_with('='); ++k) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string out;
  out.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::uint32_t digit = Base64Digit(c);
    if (digit == 64) return std::nullopt;
    bits = bits << 6U | digit;
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out += static_cast<char>(bits >> static_cast<unsigned>(count) & 0xFFU);
  }
  return out;
}

// A relative URI as a path below the folder of the file.
std::optional<std::string> PathOf(std::string_view uri) {
  std::string path;
  for (; !uri.empty(); uri.remove_prefix(1)) {
    if (uri.front() != '%') {
      path += uri.front();
      continue;
    }
    std::uint8_t byte = 0;
    const char* const end = uri.data() + std::min<std::size_t>(uri.size(), 3);
    if (uri.size() < 3 || std::from_chars(uri.data() + 1, end, byte, 16).ptr != end) {
      return std::nullopt;
    }
    path += static_cast<char>(byte);
    uri.remove_prefix(2);
  }
  const bool outside = path.empty() || path.front() == '/' ||
                       path.find("..") != std::string::npos ||
                       path.find_first_of(std::string_view(":\\\0", 3)) != std::string::npos;
  if (outside) return std::nullopt;
  return path;
}

std::size_t ComponentSize(std::size_t component) {
  switch (component) {
    case kGltfInt8:
    case kGltfUint8:
      return 1;
    case kGltfInt16:
    case kGltfUint16:
      return 2;
    case kGltfUint32:
    case kGltfFloat:
      return 4;
    default:
      return 0;
  }
}

}  // namespace

double GltfArray::At(std::size_t entry, std::size_t number) const {
  const std::size_t at = entry * stride + number * ComponentSize(component);
  const auto part = [this](double value, double largest) {
    return normalized ? std::max(value / largest, -1.0) : value;
  };
  switch (component) {
    case kGltfInt8:
      return part(NumberAt<std::int8_t>(bytes, at), 127);
    case kGltfUint8:
      return part(NumberAt<std::uint8_t>(bytes, at), 255);
    case kGltfInt16:
      return part(NumberAt<std::int16_t>(bytes, at), 32767);
    case kGltfUint16:
      return part(NumberAt<std::uint16_t>(bytes, at), 65535);
    case kGltfUint32:
      return NumberAt<std::uint32_t>(bytes, at);
    default:
      return double{NumberAt<float>(bytes, at)};
  }
}

tl::unexpected<Fault> GltfValue::Bad(std::string_view what) const {
  const bool outermost = place_.ends_with(": ");
  return Fail(FaultKind::kInvalidOption,
              fmt::format("{}{}{}", place_, outermost ? "" : ": ", what));
}

std::optional<GltfValue> GltfValue::Find(const char* member) const {
  if (!json_->is_object()) return std::nullopt;
  const auto found = json_->find(member);
  if (found == json_->end()) return std::nullopt;
  const bool outermost = place_.ends_with(": ");  // the name of the file alone
  return GltfValue(*found, fmt::format("{}{}{}", place_, outermost ? "" : ".", member));
}

GltfValue GltfValue::At(std::size_t index) const {
  return {(*json_)[index], fmt::format("{}[{}]", place_, index)};
}

Result<std::size_t> GltfValue::Whole() const {
  const auto number = json_->is_number() ? json_->get<double>() : -1.0;
  if (!(number >= 0 && number < kMostWhole && number == std::floor(number))) {
    return Bad("not a whole number of 0 or more");
  }
  return static_cast<std::size_t>(number);
}

Result<double> GltfValue::Number() const {
  if (!json_->is_number()) return Bad("not a number");
  return json_->get<double>();
}

bool GltfValue::IsTrue() const { return json_->is_boolean() && json_->get<bool>(); }

std::string_view GltfValue::Text() const {
  if (!json_->is_string()) return {};
  return json_->get_ref<const std::string&>();
}

Result<std::size_t> GltfValue::Whole(const char* member, std::optional<std::size_t> instead) const {
  if (const auto value = Find(member)) return value->Whole();
  if (instead) return *instead;
  return Bad(fmt::format("'{}' is missing", member));
}

std::string_view GltfValue::Text(const char* member) const {
  const auto value = Find(member);
  return value ? value->Text() : std::string_view();
}

GltfDocument::GltfDocument(std::string_view bytes, const std::string& name, const LoadBeside& load)
    : bytes_(bytes), name_(name), load_(load), text_(bytes), size_(bytes.size()) {}

Status GltfDocument::Open() {
  CHECK_OK(CheckSize(bytes_, name_));
  if (bytes_.starts_with(kGlbMagic)) CHECK_OK(OpenBinary());
  TRY(json_, ParseJson(WithoutByteOrderMark(text_), name_, kJsonPerByte));
  const auto asset = root().Find("asset");
  const std::string_view version = asset ? asset->Text("version") : std::string_view();
  if (version != "2" && !version.starts_with("2.")) {
    return root().Bad(fmt::format("glTF of version {}: only version 2 is read", Quoted(version)));
  }
  return {};
}

Status GltfDocument::OpenBinary() {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  if (bytes_.size() < kHeader) return FailAtByte(name_, bytes_.size(), "the file ends early");
  const auto version = NumberAt<std::uint32_t>(bytes_, 4),
             length = NumberAt<std::uint32_t>(bytes_, 8);
  if (version != 2) {
    return FailAtByte(name_, 4, fmt::format("GLB of version {}: only version 2 is read", version));
  }
  if (length != bytes_.size()) {
    return FailAtByte(
        name_, 8,
        fmt::format("the header claims {} bytes, the file has {}", length, bytes_.size()));
  }
  text_ = {};
  for (std::size_t at = kHeader, number = 0; at < bytes_.size(); ++number) {
    if (bytes_.size() - at < kChunkHeader) return FailAtByte(name_, at, "the file ends early");
    const auto size = NumberAt<std::uint32_t>(bytes_, at);
    const auto type = NumberAt<std::uint32_t>(bytes_, at + 4);
    if (size > bytes_.size() - at - kChunkHeader) {
      return FailAtByte(name_, at,
                        fmt::format("a chunk claims {} bytes, the file has {} more", size,
                                    bytes_.size() - at - kChunkHeader));
    }
    const std::string_view chunk = bytes_.substr(at + kChunkHeader, size);
    if ((number == 0) != (type == kJsonChunk)) {
      return FailAtByte(name_, at + 4, "the first chunk is JSON, and no other one");
    }
    if (type == kJsonChunk) text_ = chunk;
    if (type == kBinaryChunk && !chunk_) chunk_ = chunk;
    at += kChunkHeader + size;
  }
  return {};
}

Result<GltfValue> GltfDocument::Get(const char* list, const GltfValue& index) const {
  TRY(const std::size_t number, index.Whole());
  const auto values = root().Find(list);
  const std::size_t count = values ? values->size() : 0;
  if (number >= count) {
    return index.Bad(fmt::format("there is no {}[{}], the file has {}", list, number, count));
  }
  return values->At(number);
}

Result<GltfArray> GltfDocument::ArrayOf(const GltfValue& index, std::size_t width) {
  TRY(const GltfValue accessor, Get("accessors", index));
  GltfArray array;
  TRY(array.component, accessor.Whole("componentType"));
  TRY(array.count, accessor.Whole("count"));
  if (accessor.Text("type") != (width == 1 ? "SCALAR" : fmt::format("VEC{}", width))) {
    return accessor.Bad(
        fmt::format("the type {} does not fit here", Quoted(accessor.Text("type"))));
  }
  const auto normalized = accessor.Find("normalized");
  array.normalized = normalized && normalized->IsTrue();
  const std::size_t entry = ComponentSize(array.component) * width;
  if (entry == 0) return accessor.Bad("there is no such componentType");
  if (accessor.Find("sparse")) return accessor.Bad("sparse accessors are not read");
  const auto view_index = accessor.Find("bufferView");
  if (!view_index) return accessor.Bad("without a bufferView: compressed data are not read");
  TRY(const GltfValue view, Get("bufferViews", *view_index));
  const auto buffer_index = view.Find("buffer");
  if (!buffer_index) return view.Bad("'buffer' is missing");
  TRY(const std::string_view buffer, Buffer(*buffer_index));
  TRY(const std::size_t view_offset, view.Whole("byteOffset", 0));
  TRY(const std::size_t view_length, view.Whole("byteLength"));
  TRY(const std::size_t stride, view.Whole("byteStride", entry));
  TRY(const std::size_t offset, accessor.Whole("byteOffset", 0));
  if (view_offset > buffer.size() || view_length > buffer.size() - view_offset) {
    return view.Bad(fmt::format("{} bytes from byte {} on; the buffer has {}", view_length,
                                view_offset, buffer.size()));
  }
  if (stride < entry) return view.Bad("the byteStride is shorter than an entry");
  const std::string_view bytes = buffer.substr(view_offset, view_length);
  // Without products that overflow.
  const bool fits =
      offset <= bytes.size() && entry <= bytes.size() - offset &&
      (array.count == 0 || array.count - 1 <= (bytes.size() - offset - entry) / stride);
  if (array.count > 0 && !fits) {
    return accessor.Bad(fmt::format("{} entries of {} bytes from byte {} on; {} has {} bytes",
                                    array.count, stride, offset, "its bufferView", bytes.size()));
  }
  array.stride = stride;
  if (array.count > 0) array.bytes = bytes.substr(offset);
  return array;
}

Result<std::string_view> GltfDocument::Buffer(const GltfValue& index) {
  TRY(const std::size_t number, index.Whole());
  TRY(const GltfValue buffer, Get("buffers", index));
  TRY(const std::size_t length, buffer.Whole("byteLength"));
  const auto uri_value = buffer.Find("uri");
  std::string_view all;
  if (!uri_value) {
    if (number != 0 || !chunk_) return buffer.Bad("'uri' is missing");
    all = *chunk_;
  } else if (const auto known = buffers_.find(number); known != buffers_.end()) {
    all = known->second;
  } else {
    const std::string_view uri = uri_value->Text();
    std::string bytes;
    if (uri.starts_with("data:")) {
      constexpr std::string_view kMark = ";base64,";
      const std::size_t mark = uri.find(kMark);
      auto decoded = mark == std::string_view::npos ? std::nullopt
                                                    : FromBase64(uri.substr(mark + kMark.size()));
      if (!decoded) return uri_value->Bad("the data are not in base 64");
      bytes = *std::move(decoded);
    } else {
      const auto path = PathOf(uri);
      if (!path) {
        return uri_value->Bad(fmt::format("{} is no file in the folder of this one", Quoted(uri)));
      }
      TRY(bytes, load_(*path, length));
      size_ += bytes.size();
    }
    all = buffers_.emplace(number, std::move(bytes)).first->second;
  }
  if (length > all.size()) {
    return buffer.Bad(fmt::format("it claims {} bytes, there are {}", length, all.size()));
  }
  return all.substr(0, length);
}

}  // namespace arap
