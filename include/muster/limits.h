/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file limits.h
 * Every capacity of muster, in one place.
 *
 * Each value may be replaced at build time, e.g. `make CPPFLAGS=-DMU_AGENTS_MAX=4096`.
 * A request beyond a capacity is refused with MU_FULL and counted; nothing grows at run time.
 */
#ifndef MUSTER_LIMITS_H
#define MUSTER_LIMITS_H

/** Longest agent name, in bytes, without the terminating zero. */
#define MU_NAME_MAX 31

/** Longest name of a process, which is also its DDS partition, in bytes. */
#define MU_PROCESS_MAX 63

/** Highest DDS domain: the ports of those above it end too soon for all processes. */
#define MU_DOMAIN_MAX 230

/** Bytes of an agent's execution trace that a recording keeps of a step. */
#ifndef MU_NOTE_MAX
#define MU_NOTE_MAX 16384
#endif

/** Longest mail content, in bytes, without the terminating zero. */
#ifndef MU_CONTENT_MAX
#define MU_CONTENT_MAX 16384
#endif

/** Longest envelope field (performative, ontology, conversation ...), in bytes. */
#define MU_FIELD_MAX 63

/** Longest list of receivers that a mail can name, in bytes. */
#define MU_DST_MAX 1023

/** Longest attributes of a service, in bytes; one value has MU_FIELD_MAX at most. */
#define MU_ATTRIBUTES_MAX 255

/** Groups that a network of brokers can know. */
#ifndef MU_GROUPS_MAX
#define MU_GROUPS_MAX 1024
#endif

/** Lines of all groups together: a group takes one, and each of its members. */
#ifndef MU_MEMBERSHIPS_MAX
#define MU_MEMBERSHIPS_MAX 16384
#endif

/** Lines of the yellow pages. */
#ifndef MU_SERVICES_MAX
#define MU_SERVICES_MAX 4096
#endif

/** Brokers that one network can have. */
#ifndef MU_BROKERS_MAX
#define MU_BROKERS_MAX 32
#endif

/** Hosts that --peer can name. */
#define MU_PEERS_MAX 16

/** Longest query on services, in bytes. */
#define MU_QUERY_MAX 255

/** Constraints in one query. */
#define MU_CONSTRAINTS_MAX 16

/** Standing queries that one broker keeps. */
#ifndef MU_SUBSCRIPTIONS_MAX
#define MU_SUBSCRIPTIONS_MAX 1024
#endif

/** Standing queries of all agents in one process. */
#ifndef MU_WATCHES_MAX
#define MU_WATCHES_MAX 64
#endif

/** Agents that one broker can know. */
#ifndef MU_AGENTS_MAX
#define MU_AGENTS_MAX 16384
#endif

/** Lines of the white pages beside them: the broker and its parts. */
#define MU_BROKER_LINES 9

/** Processes that one broker or simulator can serve. */
#ifndef MU_PROCESSES_MAX
#define MU_PROCESSES_MAX 512
#endif

/** Agents that live in one process, a multiple of MU_PART_AGENTS. */
#ifndef MU_LOCAL_AGENTS_MAX
#define MU_LOCAL_AGENTS_MAX 10240
#endif

/** Agents that live in one process, unless it asks for more. */
#define MU_LOCAL_AGENTS 16

/** Agents in one part of a process's registration. */
#define MU_PART_AGENTS 64

/** Parts of a registration: a broker says all agents that it knows. */
#define MU_PARTS_MAX                                                                \
    (((MU_AGENTS_MAX > MU_LOCAL_AGENTS_MAX ? MU_AGENTS_MAX : MU_LOCAL_AGENTS_MAX) + \
      MU_PART_AGENTS - 1) /                                                         \
     MU_PART_AGENTS)

/** Brokers between an agent and a process that knows of it. */
#define MU_DISTANCE_MAX 8

/** Brokers that a mail passes at most. */
#define MU_HOPS_MAX 16

/** Mails that one broker stores, in all boxes together. */
#ifndef MU_MAILS_MAX
#define MU_MAILS_MAX 65536
#endif

/** Bytes of mail content that one broker stores. */
#ifndef MU_MAIL_BYTES_MAX
#define MU_MAIL_BYTES_MAX (64u << 20)
#endif

/** Mails that wait in one box. */
#ifndef MU_BOX_MAX
#define MU_BOX_MAX 32768
#endif

/** Bytes of mail that waits in one box. */
#ifndef MU_BOX_BYTES_MAX
#define MU_BOX_BYTES_MAX (32u << 20)
#endif

/** Bytes of mail that waits for the end of a step of the lock step. */
#ifndef MU_STEP_BYTES_MAX
#define MU_STEP_BYTES_MAX (64u << 20)
#endif

/** Agents in migration whose snapshots one broker keeps. */
#ifndef MU_CAPSULES_MAX
#define MU_CAPSULES_MAX 64
#endif

/** A snapshot with its header, in bytes with the terminating zero. */
#define MU_CAPSULE_MAX (1u << 20)

/** Probes without an answer at one broker; and those of one process. */
#ifndef MU_GLANCES_MAX
#define MU_GLANCES_MAX 64
#endif
#define MU_GLANCES_EACH 16

/** Longest probe, in bytes. */
#define MU_GLANCE_LINE_MAX 255

/** Longest answer to a probe, in bytes with the terminating zero. */
#define MU_GLANCE_BYTES_MAX (256u << 10)

/** Places in all boxes together: a mail takes one in the box of each of its receivers. */
#ifndef MU_POSTS_MAX
#define MU_POSTS_MAX (1u << 20)
#endif

/** Mails handed to a receiver and not yet acknowledged. */
#ifndef MU_WINDOW_MAX
#define MU_WINDOW_MAX 200
#endif

/** Mails that an agent has sent and the broker has not yet answered for. */
#ifndef MU_OUTBOX_MAX
#define MU_OUTBOX_MAX 1024
#endif

/** As many as a process can ask for instead, for each of its agents. */
#ifndef MU_OUTBOX_MOST
#define MU_OUTBOX_MOST 65536
#endif

/** Mails that wait until an address is resolved: of members of a lock step, and of others. */
#ifndef MU_RESOLVE_MAX
#define MU_RESOLVE_MAX 1024
#endif

/** Mails of one sender among them. */
#define MU_RESOLVE_SENDER_MAX 64

/** Lines of a trust policy. */
#ifndef MU_TRUST_LINES_MAX
#define MU_TRUST_LINES_MAX 1024
#endif

/** Audit records that wait to be written. */
#ifndef MU_AUDIT_MAX
#define MU_AUDIT_MAX 4096
#endif

/** Robots in one world. */
#ifndef MU_ROBOTS_MAX
#define MU_ROBOTS_MAX 1024
#endif

/** Sonar transducers on one robot. */
#define MU_SONARS_MAX 32

/** Beams of one laser. */
#define MU_BEAMS_MAX 1024

/** Columns of a camera's picture. */
#define MU_COLUMNS_MAX 640

/** Blobs that a camera reports at once, nearest first. */
#define MU_BLOBS_MAX 32

/** Colours that a camera looks for. */
#define MU_COLORS_MAX 16

/** Fiducials that are reported at once, nearest first. */
#define MU_FIDUCIALS_MAX 32

/** Things in one world that can be moved. */
#ifndef MU_OBJECTS_MAX
#define MU_OBJECTS_MAX 4096
#endif

/** Changes of the world from outside that wait for the end of one step. */
#define MU_ORDERS_MAX 64

/** Acts in one Frame that observers see, and mails from outside. */
#define MU_FRAME_ACTS_MAX  4096
#define MU_FRAME_MAILS_MAX 4096

/** Bytes of all that agents did in one step, and of mail from outside, that a Frame can show. */
#ifndef MU_FRAME_BYTES_MAX
#define MU_FRAME_BYTES_MAX (8u << 20)
#endif

/** Mails of one Frame that a watch hands out. */
#ifndef MU_WATCH_MAILS_MAX
#define MU_WATCH_MAILS_MAX 16384
#endif

/** Frames that wait in a watch on every step; older ones are missed. */
#ifndef MU_WATCH_BEHIND_MAX
#define MU_WATCH_BEHIND_MAX 1024
#endif

/** Walls of a Scene that a watch hands out. */
#ifndef MU_WATCH_WALLS_MAX
#define MU_WATCH_WALLS_MAX 65536
#endif

/** Robots of which every pair's nearest approach is known. */
#define MU_STATS_ALL_PAIRS 256

/** Pairs whose nearest approach is known: those of MU_STATS_ALL_PAIRS robots. */
#define MU_STATS_PAIRS_MAX 32640

/** How near two of more robots than that come before they count as a pair, in metres. */
#define MU_STATS_NEAR_M 2.0

/** Performatives that mail is counted by. */
#define MU_STATS_PERFORMATIVES 64

/** Cells that an explored world is divided into, and the finer ones of its floor. */
#define MU_EXPLORED_CELLS_MAX (1u << 20)
#define MU_EXPLORED_FINE_MAX  (1u << 24)

/** Topics in one recording. */
#ifndef MU_RECORD_CHANNELS_MAX
#define MU_RECORD_CHANNELS_MAX 1024
#endif

/** Bytes of all that a recording says of its topics and their types. */
#ifndef MU_RECORD_TYPES_BYTES
#define MU_RECORD_TYPES_BYTES (4u << 20)
#endif

/** Longest message, and largest file beside them, in a recording, in bytes. */
#ifndef MU_RECORD_MESSAGE_MAX
#define MU_RECORD_MESSAGE_MAX (8u << 20)
#endif

/** Longest key of an instance that has gone, in a recording, in bytes. */
#define MU_RECORD_KEY_MAX (64u << 10)

/** Bytes of what describes one type of another program, in a recording. */
#define MU_RECORD_TYPE_MAX (1u << 20)

/** Partitions of one writer that a recording names. */
#define MU_RECORD_PARTITIONS_MAX 32

/** Chunks of a recording that is read; one is written each second, or each megabyte. */
#ifndef MU_RECORD_CHUNKS_MAX
#define MU_RECORD_CHUNKS_MAX (1u << 20)
#endif

/** Files in a recording that is read, and tables of keys and values. */
#define MU_RECORD_FILES_MAX 1024

/** Changes of the world that wait for a time or for a condition. */
#define MU_ORDERS_LATER_MAX 256

/** Bytes of a condition, such as `red near blue 0.5`. */
#define MU_CONDITION_MAX 127

/** Rules that one robot fires in one control step, unless it is told otherwise. */
#define MU_FIRINGS_PER_STEP 200

/** Length of a control step, unless it is told otherwise. */
#define MU_STEP_NS 100000000ull

#endif
