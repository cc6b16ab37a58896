#include "server/store/blobs/s3_client.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <mutex>
#include <optional>
#include <utility>

#include <curl/curl.h>
#include <fmt/format.h>

#include "core/base/try.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

constexpr std::size_t kMostIdle = 8;
// The SHA-256 of no bytes.
constexpr const char* kNothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
// More than any mesh that the wire takes: an answer that is longer is not one of ours.
constexpr std::size_t kMostBytes = std::size_t{4} << 30u;

bool IsKeyCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-';
}

// The text between <NAME> and </NAME>; the rest of `xml` begins after it. What we read of answers
// is keys of our own, numbers and times: nothing in them is escaped.
std::optional<std::string_view> TakeElement(std::string_view& xml, std::string_view name) {
  const std::string open = fmt::format("<{}>", name), close = fmt::format("</{}>", name);
  const std::size_t start = xml.find(open);
  if (start == std::string_view::npos) return std::nullopt;
  const std::size_t end = xml.find(close, start);
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view text = xml.substr(start + open.size(), end - start - open.size());
  xml.remove_prefix(end + close.size());
  return text;
}

std::string ElementOf(std::string_view xml, std::string_view name) {
  return std::string(TakeElement(xml, name).value_or(std::string_view()));
}

// "2026-11-30T18:00:00.000Z".
std::optional<std::time_t> ParseTime(const std::string& text) {
  std::tm parts{};
  const char* const rest = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
  if (rest == nullptr) return std::nullopt;
  return timegm(&parts);
}

std::size_t Append(char* bytes, std::size_t size, std::size_t count, void* body) {
  auto& text = *static_cast<std::string*>(body);
  if (text.size() + size * count > kMostBytes) return 0;
  text.append(bytes, size * count);
  return size * count;
}

std::size_t Supply(char* buffer, std::size_t size, std::size_t count, void* left) {
  auto& bytes = *static_cast<std::string_view*>(left);
  const std::size_t taken = std::min(size * count, bytes.size());
  bytes.copy(buffer, taken);
  bytes.remove_prefix(taken);
  return taken;
}

std::size_t TakeDate(char* bytes, std::size_t size, std::size_t count, void* date) {
  const std::string line(bytes, size * count);
  constexpr std::string_view kName = "date:";
  std::string lower = line.substr(0, kName.size());
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (lower == kName) {
    *static_cast<std::time_t*>(date) = curl_getdate(line.c_str() + kName.size(), nullptr);
  }
  return size * count;
}

Fault BadUrl(std::string message) {
  return Fault(FaultKind::kInvalidOption, std::move(message)).Field("blob_store");
}

std::string Trimmed(const std::string& text) {
  const std::size_t start = text.find_first_not_of(" \t\r");
  if (start == std::string::npos) return {};
  return text.substr(start, text.find_last_not_of(" \t\r") - start + 1);
}

}  // namespace

Status ParseS3Url(const std::string& url, S3Options& options) {
  constexpr std::string_view kScheme = "s3://";
  std::string_view rest = url;
  const bool ours = rest.starts_with(kScheme);
  if (ours) rest.remove_prefix(kScheme.size());
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  const std::string_view bucket = rest.substr(0, slash);
  std::string_view prefix = rest.substr(std::min(slash + 1, rest.size()));
  while (prefix.ends_with('/')) prefix.remove_suffix(1);
  const bool good = ours && bucket.size() >= 3 && bucket.size() <= 63 &&
                    std::all_of(bucket.begin(), bucket.end(), IsKeyCharacter) &&
                    std::all_of(prefix.begin(), prefix.end(),
                                [](char c) { return IsKeyCharacter(c) || c == '/'; }) &&
                    prefix.find("//") == std::string_view::npos && !prefix.starts_with('/');
  if (!good) {
    return Fail(
        BadUrl(fmt::format("{} is not of the form s3://BUCKET[/PREFIX], with letters, "
                           "digits and ._- alone.",
                           url)));
  }
  options.bucket = bucket;
  options.prefix = prefix.empty() ? std::string() : std::string(prefix) + "/";
  return {};
}

Status ReadS3Credentials(const std::string& path, S3Options& options) {
  const auto bad = [&path](const char* what) {
    return Fail(Fault(FaultKind::kInvalidOption, fmt::format("{} {}.", path, what))
                    .Field("s3_credentials_file"));
  };
  std::ifstream file(path);
  if (!file) return bad("cannot be read");
  options.key_id.clear();
  options.secret.clear();
  options.session_token.clear();
  bool counts = true;
  for (std::string line; std::getline(file, line);) {
    line = Trimmed(line);
    if (line.starts_with('[')) counts = line == "[default]";
    const std::size_t equals = line.find('=');
    if (!counts || equals == std::string::npos || line.starts_with('#')) continue;
    const std::string name = Trimmed(line.substr(0, equals));
    const std::string value = Trimmed(line.substr(equals + 1));
    if (name == "aws_access_key_id") options.key_id = value;
    if (name == "aws_secret_access_key") options.secret = value;
    if (name == "aws_session_token") options.session_token = value;
  }
  if (options.key_id.empty() || options.secret.empty()) {
    return bad("has not both aws_access_key_id and aws_secret_access_key");
  }
  return {};
}

struct S3Client::Request {
  const char* method;
  std::string url;
  std::vector<std::string> headers = {};
  std::string_view body = {};
  std::string sha256 = kNothing;  // of the body
};

struct S3Client::Response {
  long code = 0;
  std::string body;
  std::time_t date = 0;

  bool ok() const { return code >= 200 && code < 300; }
  Fault AsFault() const {
    // "NoSuchKey", "SignatureDoesNotMatch": for people who know the store.
    std::string word = ElementOf(body, "Code");
    if (word.size() > 64 || !std::all_of(word.begin(), word.end(), IsKeyCharacter)) word.clear();
    if (code == 404 && word != "NoSuchBucket") {
      return Fault(FaultKind::kNotFound, "There is no such object.");
    }
    return Unavailable(
        fmt::format("the object store refuses with {}{}{}", code, word.empty() ? "" : " ", word));
  }
};

void S3Client::FreeHandle::operator()(void* handle) const { curl_easy_cleanup(handle); }

S3Client::S3Client(S3Options options) : options_(std::move(options)) {
  static std::once_flag once;
  std::call_once(once, [] { curl_global_init(CURL_GLOBAL_DEFAULT); });
}

S3Client::~S3Client() = default;

std::string S3Client::UrlOf(const std::string& key) const {
  return fmt::format("{}/{}/{}{}", options_.endpoint, options_.bucket, options_.prefix, key);
}

bool S3Client::Try(void* handle, const S3Options& who, const Request& request, Response& response) {
  CURL* const curl = handle;
  curl_easy_reset(curl);  // connections stay
  std::string_view left = request.body;
  curl_slist* list = nullptr;
  for (const std::string& header : request.headers) list = curl_slist_append(list, header.c_str());
  // It is signed with the rest, and the store compares it with what has arrived.
  list = curl_slist_append(list, ("x-amz-content-sha256: " + request.sha256).c_str());
  if (!who.session_token.empty()) {
    list = curl_slist_append(list, ("x-amz-security-token: " + who.session_token).c_str());
  }
  // Nothing that a server has to agree to first, and no type that would be signed.
  for (const char* header : {"Expect:", "Content-Type:"}) list = curl_slist_append(list, header);
  const std::unique_ptr<curl_slist, void (*)(curl_slist*)> headers(list, &curl_slist_free_all);

  const std::string signer = fmt::format("aws:amz:{}:s3", who.region);
  const long timeout = static_cast<long>(options_.timeout.count());
  curl_easy_setopt(curl, CURLOPT_URL, request.url.c_str());
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_NOPROXY, "localhost,127.0.0.1,::1");
  curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, request.method);
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers.get());
  curl_easy_setopt(curl, CURLOPT_AWS_SIGV4, signer.c_str());
  curl_easy_setopt(curl, CURLOPT_USERNAME, who.key_id.c_str());
  curl_easy_setopt(curl, CURLOPT_PASSWORD, who.secret.c_str());
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS, timeout);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, std::max(1L, timeout / 1'000));
  if (!who.ca.empty()) curl_easy_setopt(curl, CURLOPT_CAINFO, who.ca.c_str());
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &Append);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, &response.body);
  curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, &TakeDate);
  curl_easy_setopt(curl, CURLOPT_HEADERDATA, &response.date);
  if (std::string_view(request.method) == "PUT") {
    curl_easy_setopt(curl, CURLOPT_UPLOAD, 1L);
    curl_easy_setopt(curl, CURLOPT_READFUNCTION, &Supply);
    curl_easy_setopt(curl, CURLOPT_READDATA, &left);
    curl_easy_setopt(curl, CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(request.body.size()));
  }
  if (curl_easy_perform(curl) != CURLE_OK) return false;
  curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &response.code);
  // Of a full queue, a node that ends, and the like.
  return response.code < 500;
}

Result<S3Client::Response> S3Client::Send(const Request& request) {
  S3Options who = options_;
  if (!who.credentials_file.empty() && !ReadS3Credentials(who.credentials_file, who)) {
    return Fail(Unavailable("the file of its credentials cannot be read"));
  }
  Handle handle;
  {
    const MutexLock lock(&mutex_);
    if (!idle_.empty()) {
      handle = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (handle == nullptr) handle.reset(curl_easy_init());
  if (handle == nullptr) return Fail(FaultKind::kInternal, "libcurl makes no handle.");
  Response response;
  if (!Try(handle.get(), who, request, response)) {
    response = {};
    Try(handle.get(), who, request, response);
  }
  {
    const MutexLock lock(&mutex_);
    if (idle_.size() < kMostIdle) idle_.push_back(std::move(handle));
  }
  if (response.code == 0) return Fail(Unavailable("the object store cannot be reached"));
  return response;
}

Status S3Client::Put(const std::string& key, std::string_view bytes, const std::string& sha256,
                     bool only_if_absent) {
  Request request{"PUT", UrlOf(key), {}, bytes, sha256};
  if (only_if_absent) request.headers.emplace_back("If-None-Match: *");
  TRY(const Response response, Send(request));
  constexpr long kThere = 412;
  if (response.ok() || (only_if_absent && response.code == kThere)) return {};
  return Fail(response.code == 404 ? Unavailable("the object store has no such bucket")
                                   : response.AsFault());
}

Result<std::string> S3Client::Get(const std::string& key) {
  TRY(Response response, Send({"GET", UrlOf(key)}));
  if (!response.ok()) return Fail(response.AsFault());
  return std::move(response.body);
}

Status S3Client::Copy(const std::string& from, const std::string& to) {
  TRY(const Response response,
      Send({"PUT",
            UrlOf(to),
            {fmt::format("x-amz-copy-source: /{}/{}{}", options_.bucket, options_.prefix, from)}}));
  // A copy may fail after its answer has begun.
  if (response.ok() && response.body.find("<Error>") == std::string::npos) return {};
  return Fail(response.ok() ? Unavailable("the object store did not copy") : response.AsFault());
}

Status S3Client::Delete(const std::string& key) {
  TRY(const Response response, Send({"DELETE", UrlOf(key)}));
  if (response.ok()) return {};
  Fault fault = response.AsFault();
  if (fault.kind == FaultKind::kNotFound) return {};
  return Fail(std::move(fault));
}

Result<S3List> S3Client::List(const std::string& beginning) {
  S3List list;
  const auto escaped = [](const std::string& text) {
    std::string url;
    for (const char c : text) url += c == '/' ? std::string("%2F") : std::string(1, c);
    return url;
  };
  std::string after;
  for (bool more = true; more;) {
    // In the order of their names, as they are signed.
    std::string url =
        fmt::format("{}/{}?list-type=2&max-keys={}&prefix={}", options_.endpoint, options_.bucket,
                    options_.page, escaped(options_.prefix + beginning));
    if (!after.empty()) url += "&start-after=" + escaped(after);
    TRY(const Response response, Send({"GET", url}));
    if (response.code == 404) return Fail(Unavailable("the object store has no such bucket"));
    if (!response.ok()) return Fail(response.AsFault());
    if (list.now == 0) list.now = response.date;
    std::string_view xml = response.body;
    const std::string before = after;
    while (const auto element = TakeElement(xml, "Contents")) {
      S3Object object;
      after = ElementOf(*element, "Key");
      const std::string size = ElementOf(*element, "Size");
      const auto modified = ParseTime(ElementOf(*element, "LastModified"));
      const auto read = std::from_chars(size.data(), size.data() + size.size(), object.bytes);
      if (!after.starts_with(options_.prefix) || read.ec != std::errc{} || !modified) {
        return Fail(Unavailable("the object store did not answer what was asked"));
      }
      object.key = after.substr(options_.prefix.size());
      object.modified = *modified;
      list.objects.push_back(std::move(object));
    }
    more = ElementOf(response.body, "IsTruncated") == "true";
    if (more && after <= before) {
      return Fail(Unavailable("the object store did not answer what was asked"));
    }
  }
  return list;
}

}  // namespace arap::store
