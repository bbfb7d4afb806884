/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/topics.h"

#include "bus/check.h"
#include "wire.h"

#include <stdio.h>
#include <string.h>

const struct topic topic_table[BUS_TOPICS] = {
    [BUS_REGISTRATION] =
        {"Registration", &muster_Registration_desc, .for_late_comers = true,
         .liveliness_ns = DDS_SECS(1), .check = check_registration, .partition = "default",
         .from_to = "agent's process to broker and simulator",
         .carries =
             "the agents of a process, 64 in a part, and their states; its liveliness is theirs"},
    [BUS_UP] = {"Up", &muster_Up_desc, .keeps_all = true, .local = true, .check = check_up,
                .partition = "`broker.NAME`; `simulator` too for robots",
                .from_to = "agent's process to broker and simulator",
                .carries = "what its agents did in a step: speeds, mails, rules fired"},
    [BUS_SENSE] = {"Sense", &muster_Sense_desc, .local = true, .describer = DESCRIBED_BY_AGENTS,
                   .check = check_sense, .partition = "the process",
                   .from_to = "simulator to robot's process",
                   .carries = "a new step: percepts of the process's robots"},
    [BUS_DELIVERY] = {"Delivery", &muster_Delivery_desc, .keeps_all = true, .local = true,
                      .describer = DESCRIBED_TO_ALL, .check = check_delivery,
                      .partition = "the process; `to all`; `*` finds processes and carries nothing",
                      .from_to = "broker to agent's process",
                      .carries =
                          "mails, receipts, changes of the white and yellow pages and groups"},
    [BUS_ROSTER] = {"Roster", &muster_Roster_desc, .for_late_comers = true, .check = check_roster,
                    .partition = "default", .from_to = "simulator to broker",
                    .carries = "the processes that every step waits for"},
    [BUS_RUN_COMMAND] = {"RunCommand", &muster_RunCommand_desc, .for_late_comers = true,
                         .depth = 32, .check = check_run_command, .partition = "default",
                         .from_to = "`muster run`, `muster world` or any process to simulator",
                         .carries = "start the first step, end the run; place, push, reset, pace, "
                                    "save, sensors on and off"},
    [BUS_RUN_ANSWER] = {"RunAnswer", &muster_RunAnswer_desc, .for_late_comers = true, .depth = 32,
                        .check = check_run_answer, .partition = "default",
                        .from_to = "simulator to the writer of a RunCommand",
                        .carries = "what became of it, and at which step"},
    [BUS_RUN_STATUS] = {"RunStatus", &muster_RunStatus_desc, .for_late_comers = true,
                        .check = check_run_status, .partition = "default",
                        .from_to = "simulator to observers",
                        .carries = "how far the run is; its hash when it is done"},
    [BUS_PAGES] = {"Pages", &muster_Page_desc, .for_late_comers = true, .check = check_page,
                   .partition = "default", .from_to = "broker to observers",
                   .carries = "the white pages, a line an agent, 64 in a part"},
    [BUS_BROKER_STATUS] = {"BrokerStatus", &muster_BrokerStatus_desc, .for_late_comers = true,
                           .check = check_broker_status, .partition = "default",
                           .from_to = "broker to observers",
                           .carries = "counters of mail, its age, processor time, memory"},
    [BUS_PART_STATUS] = {"PartStatus", &muster_PartStatus_desc, .for_late_comers = true,
                         .check = check_part_status, .partition = "default",
                         .from_to = "broker to observers",
                         .carries = "counters of one part of the broker"},
    [BUS_BROKER_EVENT] = {"BrokerEvent", &muster_BrokerEvent_desc, .depth = 32,
                          .check = check_broker_event, .partition = "default",
                          .from_to = "broker to observers",
                          .carries = "mail that is refused or dropped, soon after it is"},
    [BUS_BEACON] = {"Beacon", &muster_Beacon_desc, .for_late_comers = true,
                    .liveliness_ns = DDS_SECS(1), .check = check_beacon, .partition = "default",
                    .from_to = "broker to agents' processes and the other brokers",
                    .carries = "a broker is there; its liveliness is the broker's"},
    [BUS_SCENE] = {"Scene", &muster_Scene_desc, .for_late_comers = true, .check = check_scene,
                   .partition = "default", .from_to = "simulator to observers",
                   .carries = "the world, once: walls, robots, objects, where sensors stand"},
    [BUS_FRAME] = {"Frame", &muster_Frame_desc, .depth = 64, .check = check_frame,
                   .partition = "`every`: each step; `latest`: one every 40 ms at most",
                   .from_to = "simulator to observers",
                   .carries = "a step as a whole: poses, percepts, what was done, mails"},
};

const struct topic *topics_find(const char *name, const char *type)
{
    for (size_t i = 0; i < BUS_TOPICS; i++) {
        if (strcmp(topic_table[i].name, name) == 0 &&
            strcmp(topic_table[i].descriptor->m_typename, type) == 0) {
            return &topic_table[i];
        }
    }
    return NULL;
}

int32_t topics_depth(const struct topic *topic)
{
    return topic->depth ? topic->depth : 1;
}

dds_qos_t *topics_qos(const struct topic *topic)
{
    dds_qos_t *qos = dds_create_qos();
    MU_ASSERT(qos);
    /* A write never blocks: a timeout leaves the sample with its owner, which tries again. */
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
    dds_qset_history(qos, topic->keeps_all ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST,
                     topic->keeps_all ? 0 : topics_depth(topic));
    /* A crash must look different from a clean leave. */
    dds_qset_writer_data_lifecycle(qos, false);
    if (topic->for_late_comers) {
        dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
    }
    if (topic->liveliness_ns) { /* its writer is a process: it says of which version */
        dds_qset_userdata(qos, TOPICS_VERSION, sizeof TOPICS_VERSION - 1);
        dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, topic->liveliness_ns);
    }
    return qos;
}

/* The same without what a tool can learn the type from. */
static dds_topic_descriptor_t descriptor_untyped(const dds_topic_descriptor_t *d)
{
    return (dds_topic_descriptor_t){.m_size = d->m_size,
                                    .m_align = d->m_align,
                                    .m_flagset = d->m_flagset & ~DDS_TOPIC_XTYPES_METADATA,
                                    .m_nkeys = d->m_nkeys,
                                    .m_typename = d->m_typename,
                                    .m_keys = d->m_keys,
                                    .m_nops = d->m_nops,
                                    .m_ops = d->m_ops,
                                    .m_meta = d->m_meta};
}

static bool is_described(const struct bus *bus, const struct topic *t, const char *partition)
{
    if (bus->place == BUS_OBSERVER) {
        return true;
    }
    bool is_agent = bus->place == BUS_AGENT;
    return t->describer == DESCRIBED_TO_ALL
               ? !is_agent && partition && strcmp(partition, BUS_TO_ALL) == 0
               : is_agent == (t->describer == DESCRIBED_BY_AGENTS);
}

dds_entity_t topics_open(struct bus *bus, enum bus_topic topic, const char *partition)
{
    const struct topic *t = &topic_table[topic];
    bool described = is_described(bus, t, partition);
    int32_t *made = &bus->topics[topic][described];
    if (*made <= 0) {
        const dds_topic_descriptor_t bare = descriptor_untyped(t->descriptor);
        *made = dds_create_topic(bus->participant, described ? t->descriptor : &bare, t->name, NULL,
                                 NULL);
    }
    return *made;
}

static void matches_count(dds_entity_t writer, dds_publication_matched_status_t status, void *bus)
{
    (void)writer;
    (void)status;
    atomic_fetch_add(&((struct bus *)bus)->matches, 1);
}

dds_entity_t topics_writer(struct bus *bus, enum bus_topic topic, const char *first,
                           const char *second)
{
    dds_entity_t about = topics_open(bus, topic, first);
    const char *partitions[] = {first ? first : "", second};
    dds_qos_t *group = dds_create_qos();
    dds_qset_partition(group, second ? 2 : 1, partitions);
    dds_entity_t publisher = dds_create_publisher(bus->participant, group, NULL);
    dds_delete_qos(group);
    dds_qos_t *qos = topics_qos(&topic_table[topic]);
    dds_listener_t *listener = dds_create_listener(bus);
    if (topic_table[topic].local) {
        dds_lset_publication_matched(listener, matches_count);
    }
    dds_entity_t writer = about < 0 ? about : dds_create_writer(publisher, about, qos, listener);
    dds_delete_listener(listener);
    dds_delete_qos(qos);
    if (writer < 0) {
        dds_delete(publisher);
    }
    return writer;
}

void topics_writer_delete(dds_entity_t writer)
{
    if (writer > 0) {
        dds_delete(dds_get_parent(writer)); /* its publisher, and it */
    }
}

void bus_print_topics(void)
{
    printf("| topic | type | history | durability | partition | from, to | way | carries |\n"
           "|---|---|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < BUS_TOPICS; i++) {
        const struct topic *t = &topic_table[i];
        char history[32] = "keep all";
        if (!t->keeps_all) {
            snprintf(history, sizeof history, "keep last %d", (int)topics_depth(t));
        }
        printf("| `%s` | `%s` | %s | %s%s | %s | %s | %s | %s |\n", t->name,
               t->descriptor->m_typename, history,
               t->for_late_comers ? "transient local" : "volatile",
               t->liveliness_ns ? ", liveliness automatic 1 s" : "", t->partition, t->from_to,
               t->local ? "sockets on one host, else DDS" : "DDS", t->carries);
    }
    printf("\nAll are reliable, with a maximum blocking time of 0.\n");
}
