#include "core/files/bytes.h"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>
#include <zlib.h>

#include "core/base/try.h"

namespace arap {
namespace {

constexpr std::string_view kGzipMagic = "\x1f\x8b";

// Goes through packed bytes once.
class Unpacker {
 public:
  Unpacker(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {
    constexpr int kGzipAlone = 16 + MAX_WBITS;
    ready_ = inflateInit2(&stream_, kGzipAlone) == Z_OK;
  }
  ~Unpacker() { inflateEnd(&stream_); }
  Unpacker(const Unpacker&) = delete;
  Unpacker& operator=(const Unpacker&) = delete;

  // The next bytes, at most as many as there is room for; none at the end.
  Result<std::size_t> Next(char* out, std::size_t room) {
    if (!ready_) return Fail(FaultKind::kOutOfMemory, "There is not enough memory for this.");
    const std::size_t most = std::min<std::size_t>(room, std::numeric_limits<uInt>::max());
    // zlib takes no const pointers, and reads only.
    stream_.next_out = reinterpret_cast<Bytef*>(out);
    stream_.avail_out = static_cast<uInt>(most);
    while (stream_.avail_out > 0 && !ended_) CHECK_OK(Step());
    return most - stream_.avail_out;
  }

 private:
  tl::unexpected<Fault> Bad(std::string_view what) const { return FailAtByte(name_, at_, what); }

  Status Step() {
    const std::size_t given = std::min<std::size_t>(bytes_.size() - at_, kPiece);
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes_.data() + at_));
    stream_.avail_in = static_cast<uInt>(given);
    const uInt room = stream_.avail_out;
    const int result = inflate(&stream_, Z_NO_FLUSH);
    at_ += given - stream_.avail_in;
    if (result == Z_STREAM_END) return NextPart();
    if (result == Z_MEM_ERROR) {
      return Fail(FaultKind::kOutOfMemory, "There is not enough memory for this.");
    }
    if (result != Z_OK && result != Z_BUF_ERROR) {
      return Bad(fmt::format("damaged data of gzip: {}",
                             stream_.msg != nullptr ? stream_.msg : "of an unknown kind"));
    }
    if (stream_.avail_in == given && stream_.avail_out == room) {
      return Bad("the file ends within data of gzip");
    }
    return {};
  }

  Status NextPart() {
    ended_ = at_ == bytes_.size();
    if (ended_) return {};
    if (!bytes_.substr(at_).starts_with(kGzipMagic)) {
      return Bad(fmt::format("the file goes on for {} bytes behind the data of gzip",
                             bytes_.size() - at_));
    }
    inflateReset(&stream_);
    return {};
  }

  static constexpr std::size_t kPiece = std::size_t{1} << 30U;

  std::string_view bytes_;
  const std::string& name_;
  z_stream stream_{};
  bool ready_ = false, ended_ = false;
  std::size_t at_ = 0;
};

}  // namespace

bool IsGzip(std::string_view bytes) { return bytes.starts_with(kGzipMagic); }

Result<std::string> Unpack(std::string_view bytes, const std::string& name, std::size_t most) {
  std::size_t size = 0;
  Unpacker first(bytes, name);
  for (std::array<char, std::size_t{1} << 16U> piece{};;) {
    TRY(const std::size_t count, first.Next(piece.data(), piece.size()));
    if (count == 0) break;
    size += count;
    if (size > most) {
      return Fail(FaultKind::kInvalidOption,
                  fmt::format("{}: {} bytes of gzip unpack to more than {}, which is the limit",
                              name, bytes.size(), most));
    }
  }
  std::string out(size, '\0');
  Unpacker again(bytes, name);
  for (std::size_t done = 0; done < size;) {
    TRY(const std::size_t count, again.Next(out.data() + done, size - done));
    done += count;
  }
  return out;
}

}  // namespace arap
