#include "arap/client/deform_stream.h"

#include <utility>

#include "arap/client/session.h"
#include "client/src/answers.h"
#include "client/src/deform_stream_impl.h"
#include "proto/convert/deform.h"
#include "proto/convert/plain.h"

namespace arap::client {

using convert::AppendPoints;
using convert::ToWire;

Result<DeformStream> Session::OpenStream(const std::string& handle_set_id,
                                         const StreamOptions& options,
                                         const CallOptions& call) const {
  v1::OpenStream open;
  open.set_session_id(id_);
  open.set_handle_set_id(handle_set_id);
  open.set_delivery(options.delivery == Delivery::kEvery ? v1::DELIVERY_EVERY
                                                         : v1::DELIVERY_LATEST);
  internal::ToWire(options.shape, open.mutable_options());
  auto impl =
      std::make_unique<DeformStream::Impl>(channel_, sizes_, options, call, std::move(open));
  return impl->Open().map([&] { return DeformStream(std::move(impl)); });
}

DeformStream::DeformStream(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
DeformStream::DeformStream(DeformStream&&) noexcept = default;
DeformStream& DeformStream::operator=(DeformStream&&) noexcept = default;
DeformStream::~DeformStream() = default;

const HandleSetInfo& DeformStream::handle_set() const { return impl_->handle_set(); }

Status DeformStream::Send(const HandleUpdate& update) {
  v1::StreamDeformRequest request;
  v1::HandleUpdate& out = *request.mutable_update();
  out.set_sequence(update.sequence);
  for (const HandleTarget& target : update.targets) ToWire(target, out.add_targets());
  AppendPoints(update.positions, out.mutable_positions());
  AppendPoints(update.pick_points, out.mutable_pick_points());
  out.set_measure(update.measure);
  return impl_->Send(std::move(request));
}

Status DeformStream::Edit(std::uint64_t sequence, std::span<const std::string> remove,
                          std::span<const Handle> add) {
  v1::StreamDeformRequest request;
  v1::HandleEdit& out = *request.mutable_edit();
  out.set_sequence(sequence);
  out.mutable_remove()->Add(remove.begin(), remove.end());
  for (const Handle& handle : add) ToWire(handle, out.add_add());
  return impl_->Send(std::move(request));
}

Status DeformStream::Ping(std::uint64_t nonce) { return impl_->Ping(nonce); }

Status DeformStream::CloseSending() { return impl_->CloseSending(); }

Result<std::optional<StreamEvent>> DeformStream::Read() { return impl_->Read(); }

void DeformStream::Cancel() { impl_->Cancel(); }

}  // namespace arap::client
