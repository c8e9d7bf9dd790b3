/* SPDX-License-Identifier: Apache-2.0 */
/* service_client DOMAIN NAME...: calls services of type std_srvs/Trigger one after the other, as a node of ROS 2 on
 * Cyclone DDS does, over loopback. Prints a line for each: name, whether it succeeded, its message. `hear:NAME` is no
 * service but a latched topic of type std_msgs/String, of which the last message is printed. Knows nothing of tuina:
 * the types are described to Cyclone as its own generator would. */
#include <dds/dds.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
  uint64_t client;
  int64_t sequence;
  uint8_t structure_needs_at_least_one_member;
};
struct answer {
  uint64_t client;
  int64_t sequence;
  bool success;
  char* message;
};

static const uint32_t request_fields[] = {
    DDS_OP_ADR | DDS_OP_TYPE_8BY, offsetof(struct request, client),
    DDS_OP_ADR | DDS_OP_TYPE_8BY | DDS_OP_FLAG_SGN, offsetof(struct request, sequence),
    DDS_OP_ADR | DDS_OP_TYPE_1BY, offsetof(struct request, structure_needs_at_least_one_member),
    DDS_OP_RTS};
static const dds_topic_descriptor_t request_type = {
    .m_size = sizeof(struct request),
    .m_align = 8,
    .m_flagset = DDS_TOPIC_NO_OPTIMIZE,
    .m_typename = "std_srvs::srv::dds_::Trigger_Request_",
    .m_nops = 4,
    .m_ops = request_fields,
    .m_meta = ""};
static const uint32_t answer_fields[] = {
    DDS_OP_ADR | DDS_OP_TYPE_8BY, offsetof(struct answer, client),
    DDS_OP_ADR | DDS_OP_TYPE_8BY | DDS_OP_FLAG_SGN, offsetof(struct answer, sequence),
    DDS_OP_ADR | DDS_OP_TYPE_BLN, offsetof(struct answer, success),
    DDS_OP_ADR | DDS_OP_TYPE_STR, offsetof(struct answer, message),
    DDS_OP_RTS};
static const dds_topic_descriptor_t answer_type = {
    .m_size = sizeof(struct answer),
    .m_align = 8,
    .m_flagset = DDS_TOPIC_NO_OPTIMIZE,
    .m_typename = "std_srvs::srv::dds_::Trigger_Response_",
    .m_nops = 5,
    .m_ops = answer_fields,
    .m_meta = ""};

struct text {
  char* data;
};
static const uint32_t text_fields[] = {DDS_OP_ADR | DDS_OP_TYPE_STR, offsetof(struct text, data),
                                       DDS_OP_RTS};
static const dds_topic_descriptor_t text_type = {.m_size = sizeof(struct text),
                                                 .m_align = sizeof(char*),
                                                 .m_flagset = DDS_TOPIC_NO_OPTIMIZE,
                                                 .m_typename = "std_msgs::msg::dds_::String_",
                                                 .m_nops = 2,
                                                 .m_ops = text_fields,
                                                 .m_meta = ""};

static const char loopback[] =
    "<CycloneDDS><Domain><General>"
    "<Interfaces><NetworkInterface address=\"127.0.0.1\" multicast=\"false\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery></Domain></CycloneDDS>";

static dds_entity_t checked(dds_entity_t made, const char* what) {
  if (made >= 0) return made;
  fprintf(stderr, "%s: %s\n", what, dds_strretcode(made));
  exit(1);
}

/* Asks and waits for the answer to this very call; false where none comes within two seconds. */
static bool call(dds_entity_t writer, dds_entity_t reader, int64_t sequence, struct answer* into) {
  dds_instance_handle_t self = 0;
  checked(dds_get_instance_handle(writer, &self), "handle");
  const struct request asked = {.client = self, .sequence = sequence};
  checked(dds_write(writer, &asked), "request");
  const dds_time_t end = dds_time() + DDS_SECS(2);
  while (dds_time() < end) {
    void* sample = into;
    dds_sample_info_t info;
    if (dds_take(reader, &sample, &info, 1, 1) != 1)
      dds_sleepfor(DDS_MSECS(1));
    else if (info.valid_data && into->client == self && into->sequence == sequence)
      return true;
  }
  return false;
}

/* Prints what is latched on a topic; false where nothing comes within five seconds. */
static bool hear(dds_entity_t participant, const char* name) {
  char topic[200];
  snprintf(topic, sizeof topic, "rt%s", name);
  const dds_entity_t texts =
      checked(dds_create_topic(participant, &text_type, topic, NULL, NULL), "topic of texts");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  const dds_entity_t reader = checked(dds_create_reader(participant, texts, qos, NULL), "reader");
  dds_delete_qos(qos);
  struct text text = {.data = NULL};
  bool heard = false;
  for (const dds_time_t end = dds_time() + DDS_SECS(5); !heard && dds_time() < end;) {
    void* sample = &text;
    dds_sample_info_t info;
    if (dds_take(reader, &sample, &info, 1, 1) != 1)
      dds_sleepfor(DDS_MSECS(1));
    else
      heard = info.valid_data;
  }
  printf("%s %s\n", name, heard ? text.data : "unheard");
  dds_free(text.data);
  dds_delete(reader), dds_delete(texts);
  return heard;
}

int main(int argc, char** argv) {
  if (argc < 3) return fputs("service_client DOMAIN NAME...\n", stderr), 1;
  const dds_domainid_t domain = (dds_domainid_t)atoi(argv[1]);
  checked(dds_create_domain(domain, loopback), "domain");
  const dds_entity_t participant =
      checked(dds_create_participant(domain, NULL, NULL), "participant");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
  int failed = 0;
  for (int i = 2; i < argc; ++i) {
    if (strncmp(argv[i], "hear:", 5) == 0) {
      if (!hear(participant, argv[i] + 5)) failed = 1;
      continue;
    }
    char topic[200];
    snprintf(topic, sizeof topic, "rq%sRequest", argv[i]);
    const dds_entity_t requests = checked(
        dds_create_topic(participant, &request_type, topic, NULL, NULL), "topic of requests");
    snprintf(topic, sizeof topic, "rr%sReply", argv[i]);
    const dds_entity_t answers =
        checked(dds_create_topic(participant, &answer_type, topic, NULL, NULL), "topic of answers");
    const dds_entity_t writer =
        checked(dds_create_writer(participant, requests, qos, NULL), "writer");
    const dds_entity_t reader =
        checked(dds_create_reader(participant, answers, qos, NULL), "reader");
    const dds_time_t end = dds_time() + DDS_SECS(5);
    while (dds_time() < end && (dds_get_matched_subscriptions(writer, NULL, 0) < 1 ||
                                dds_get_matched_publications(reader, NULL, 0) < 1))
      dds_sleepfor(DDS_MSECS(5));
    struct answer answer = {.message = NULL};
    if (call(writer, reader, i, &answer))
      printf("%s %s %s\n", argv[i], answer.success ? "true" : "false", answer.message);
    else
      printf("%s unanswered\n", argv[i]), failed = 1;
    fflush(stdout);
    dds_free(answer.message);
    dds_delete(requests), dds_delete(answers);
  }
  dds_delete_qos(qos);
  dds_delete(participant);
  return failed;
}
