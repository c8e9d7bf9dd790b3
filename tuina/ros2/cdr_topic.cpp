// SPDX-License-Identifier: Apache-2.0
#include "tuina/ros2/cdr_topic.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstring>

namespace tuina::ros2 {
namespace {

/// One message as Cyclone holds it.
struct CdrSample : ddsi_serdata {
  std::string bytes;
};

CdrSample* new_sample(const ddsi_sertype* type, ddsi_serdata_kind kind) {
  auto* sample = new CdrSample();
  ddsi_serdata_init(sample, type, kind);
  return sample;
}
// Cyclone sends whole words, and reads past the end of bytes that are none.
ddsi_serdata* padded(CdrSample* sample) {
  sample->bytes.resize((sample->bytes.size() + 3) / 4 * 4, '\0');
  return sample;
}
const std::string& bytes_of(const ddsi_serdata* sample) {
  return static_cast<const CdrSample*>(sample)->bytes;
}

// Without keys all samples are of one instance.
bool same_key(const ddsi_serdata*, const ddsi_serdata*) {
  return true;
}
std::uint32_t size_of(const ddsi_serdata* sample) {
  return static_cast<std::uint32_t>(bytes_of(sample).size());
}
ddsi_serdata* from_key(const ddsi_sertype* type, const ddsi_keyhash*) {
  return new_sample(type, SDK_KEY);
}
ddsi_serdata* from_string(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* bytes) {
  CdrSample* sample = new_sample(type, kind);
  sample->bytes = *static_cast<const std::string*>(bytes);
  return padded(sample);
}
// Pieces come in order; one may repeat what those before it brought.
ddsi_serdata* from_network(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* piece,
                           std::size_t size) {
  CdrSample* sample = new_sample(type, kind);
  std::string& bytes = sample->bytes;
  const std::size_t wanted = std::min(size, max_received_bytes);
  for (; piece != nullptr && bytes.size() < wanted; piece = piece->nextfrag) {
    if (piece->maxp1 <= bytes.size()) continue;
    const auto* first =
        reinterpret_cast<const char*>(NN_RMSG_PAYLOADOFF(piece->rmsg, NN_RDATA_PAYLOAD_OFF(piece)));
    const std::size_t known = bytes.size() - piece->min;
    bytes.append(first + known, std::min<std::size_t>(piece->maxp1, wanted) - bytes.size());
  }
  return sample;
}
ddsi_serdata* from_parts(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t parts,
                         const ddsrt_iovec_t* part, std::size_t) {
  CdrSample* sample = new_sample(type, kind);
  for (std::size_t i = 0; i < parts; ++i) {
    const std::size_t room = max_received_bytes - sample->bytes.size();
    sample->bytes.append(static_cast<const char*>(part[i].iov_base),
                         std::min<std::size_t>(part[i].iov_len, room));
  }
  return sample;
}
void copy_bytes(const ddsi_serdata* sample, std::size_t at, std::size_t size, void* to) {
  std::memcpy(to, bytes_of(sample).data() + at, size);
}
ddsi_serdata* lend_bytes(const ddsi_serdata* sample, std::size_t at, std::size_t size,
                         ddsrt_iovec_t* to) {
  to->iov_base = const_cast<char*>(bytes_of(sample).data()) + at;
  to->iov_len = size;
  return ddsi_serdata_ref(sample);
}
void take_back(ddsi_serdata* sample, const ddsrt_iovec_t*) {
  ddsi_serdata_unref(sample);
}
bool to_string(const ddsi_serdata* sample, void* bytes, void**, void*) {
  *static_cast<std::string*>(bytes) = bytes_of(sample);
  return true;
}
ddsi_serdata* without_type(const ddsi_serdata* sample) {
  CdrSample* bare = new_sample(sample->type, SDK_KEY);
  bare->type = nullptr;
  return bare;
}
bool key_to_string(const ddsi_sertype*, const ddsi_serdata*, void* bytes, void**, void*) {
  static_cast<std::string*>(bytes)->clear();
  return true;
}
void free_sample(ddsi_serdata* sample) {
  delete static_cast<CdrSample*>(sample);
}
std::size_t print(const ddsi_sertype*, const ddsi_serdata*, char* text, std::size_t size) {
  if (size > 0) *text = '\0';
  return 0;
}
void key_hash(const ddsi_serdata*, ddsi_keyhash* hash, bool) {
  std::memset(hash, 0, sizeof(*hash));
}

// A sample that says only that a writer has gone is made of what the caller gave: Cyclone has its
// content freed, and then all of it set to zero.
void free_contents(const ddsi_sertype*, void** samples, std::size_t count, dds_free_op_t) {
  for (std::size_t i = 0; i < count; ++i) static_cast<std::string*>(samples[i])->clear();
}
void set_to_zero(const ddsi_sertype*, void* samples, std::size_t count) {
  auto* first = static_cast<std::string*>(samples);
  for (std::size_t i = 0; i < count; ++i) first[i].clear();
}

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}
// Cyclone has compared the names already.
bool same_type(const ddsi_sertype*, const ddsi_sertype*) {
  return true;
}
std::uint32_t no_hash(const ddsi_sertype*) {
  return 0;
}

const ddsi_serdata_ops sample_functions = {.eqkey = same_key,
                                           .get_size = size_of,
                                           .from_ser = from_network,
                                           .from_ser_iov = from_parts,
                                           .from_keyhash = from_key,
                                           .from_sample = from_string,
                                           .to_ser = copy_bytes,
                                           .to_ser_ref = lend_bytes,
                                           .to_ser_unref = take_back,
                                           .to_sample = to_string,
                                           .to_untyped = without_type,
                                           .untyped_to_sample = key_to_string,
                                           .free = free_sample,
                                           .print = print,
                                           .get_keyhash = key_hash};
// Samples are the caller's, so Cyclone makes none. A type that describes itself could be found not
// to match, and ROS 2 asks for none.
const ddsi_sertype_ops type_functions = {.version = ddsi_sertype_v0,
                                         .free = free_type,
                                         .zero_samples = set_to_zero,
                                         .free_samples = free_contents,
                                         .equal = same_type,
                                         .hash = no_hash};

}  // namespace

std::int32_t create_cdr_topic(std::int32_t participant, const std::string& topic,
                              const std::string& type) {
  auto* made = new ddsi_sertype();
  ddsi_sertype_init_flags(made, type.c_str(), &type_functions, &sample_functions,
                          DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  made->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  const dds_entity_t created =
      dds_create_topic_sertype(participant, topic.c_str(), &made, nullptr, nullptr, nullptr);
  if (created < 0) ddsi_sertype_unref(made);
  return created;
}

}  // namespace tuina::ros2
