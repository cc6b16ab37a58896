// S3Client: the few requests to an S3-compatible object store that blobs need.
#pragma once

#include <chrono>
#include <cstddef>
#include <ctime>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "core/base/mutex.h"

namespace arap::store {

// Where the objects are, and who asks for them.
struct S3Options {
  std::string bucket;
  std::string prefix;    // of all keys: empty, or letters, digits and ._-/ with a slash at the end
  std::string endpoint;  // https://HOST[:PORT]; buckets are the first part of the path
  std::string region = "us-east-1";
  // Read again for every request, so that new ones need no restart; empty: those below.
  std::string credentials_file = {};
  std::string key_id = {}, secret = {}, session_token = {};
  std::string ca = {};                        // authorities in PEM; empty: those of this machine
  std::chrono::milliseconds timeout{10'000};  // of connecting, and of silence
  int page = 1'000;                           // objects in an answer to List
};

// From "s3://BUCKET[/PREFIX]" into `options`. kInvalidOption with the field "blob_store".
Status ParseS3Url(const std::string& url, S3Options& options);

// Of a file as other programs have it too: lines NAME = VALUE with aws_access_key_id,
// aws_secret_access_key and perhaps aws_session_token, of which those before any [profile] or under
// [default] count. kInvalidOption with the path and the field "s3_credentials_file"; no fault has
// a part of the text.
Status ReadS3Credentials(const std::string& path, S3Options& options);

// A thing in the bucket.
struct S3Object {
  std::string key;  // without the prefix
  std::size_t bytes = 0;
  std::time_t modified = 0;
};

struct S3List {
  std::vector<S3Object> objects;  // by key
  std::time_t now = 0;            // by the clock of the object store, which gives `modified`
};

// Thread-safe; as many connections as there are requests at a time, kept for the next ones. Calls
// block for as long as the bytes take, but no longer than the timeout in silence, and are made once
// more when the connection breaks or the store says that it is busy. kStoreUnavailable when it
// cannot be reached or refuses, kNotFound where said. Secrets are in no fault.
class S3Client {
 public:
  explicit S3Client(S3Options options);
  ~S3Client();
  S3Client(const S3Client&) = delete;
  S3Client& operator=(const S3Client&) = delete;

  // `sha256` is that of the bytes, which the store checks. With `only_if_absent` a store that knows
  // such conditions keeps what is there; that is no fault.
  Status Put(const std::string& key, std::string_view bytes, const std::string& sha256,
             bool only_if_absent = false);
  // kNotFound when there is no such object.
  Result<std::string> Get(const std::string& key);
  // Within the store. kNotFound likewise.
  Status Copy(const std::string& from, const std::string& to);
  // Also when there was none.
  Status Delete(const std::string& key);
  // All objects whose keys begin so; a request for each thousand of them.
  Result<S3List> List(const std::string& beginning);

 private:
  struct Request;
  struct Response;
  struct FreeHandle {
    void operator()(void* handle) const;
  };
  using Handle = std::unique_ptr<void, FreeHandle>;

  std::string UrlOf(const std::string& key) const;
  Result<Response> Send(const Request& request);
  // Once, on this handle. False when it is worth another try.
  bool Try(void* handle, const S3Options& who, const Request& request, Response& response);

  const S3Options options_;
  Mutex mutex_;
  std::vector<Handle> idle_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::store
