/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The border, topic by topic: a whole sample passes, and each of its fields is spoilt once in every
 * way that its kind knows.
 */
#include "bus/check.h"
#include "bus/bus.h"
#include "bus/topics.h"
#include "muster/limits.h"
#include "suite.h"
#include "wire.h"

#include <CUnit/Basic.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { RULES_MAX = 64 * 1024, TEXT_MAX = 270 * 1024, FEW = 3 };

/* idlc makes no const members; the checks write to none. */
#define W(s) ((char *)(uintptr_t)(s))
#define LIST(buffer)                                         \
    {                                                        \
        ._length = FEW, ._maximum = FEW, ._buffer = (buffer) \
    }

#define A_MAIL                                                                              \
    {                                                                                       \
        .src = W("red"), .seq = 1, .dst = W("blue"), .layer = 3, .performative = W("tell"), \
        .language = W(""), .ontology = W(""), .reply_with = W(""), .in_reply_to = W(""),    \
        .conversation = W(""), .due_ns = -1, .content = W("hello")                          \
    }
#define A_MEMBER                                                                   \
    {                                                                              \
        .name = W("red"), .process = W("p1"), .broker = W("b1"), .host = W("here") \
    }

static muster_Mail mails[MU_OUTBOX_MAX + 1] = {A_MAIL, A_MAIL, A_MAIL};
static muster_Act acts[MU_LOCAL_AGENTS_MAX + 1] = {
    {.agent = W("red"), .rules = W("wander"), .goal = W(""), .diary = W("")},
    {.agent = W("blue"), .rules = W(""), .goal = W(""), .diary = W("")},
    {.agent = W("green"),
     .rules = W("a b"),
     .mails = LIST(mails),
     .goal = W("stay"),
     .diary = W("S\n")},
};
static muster_Ack acks[MU_LOCAL_AGENTS_MAX + 1] = {
    {.box = W("a")}, {.box = W("b")}, {.box = W("c")}};
#define A_GLANCE(says, what)                                                                      \
    {                                                                                             \
        .word = (says), .asker = W("operator-1"), .number = 1, .agent = W("red"), .text = W(what) \
    }
static muster_Glance glances[MU_GLANCES_MAX + 1] = {A_GLANCE(muster_GLANCE_ASK, "(facts)"),
                                                    A_GLANCE(muster_GLANCE_DECLINED, ""),
                                                    A_GLANCE(muster_GLANCE_DONE, "f-0")};
static muster_Up up = {
    .process = W("p1"), .acts = LIST(acts), .acks = LIST(acks), .glances = LIST(glances)};

static float sonar_m[MU_SONARS_MAX + 1] = {0.5f, 1.0f, 2.0f};
static float laser_m[MU_BEAMS_MAX + 1] = {0.5f, 1.0f, 2.0f};
static muster_Blob blobs[MU_BLOBS_MAX + 1];
static muster_Fiducial fiducials[MU_FIDUCIALS_MAX + 1];
static muster_Percept percepts[MU_LOCAL_AGENTS_MAX + 1] = {{.robot = W("red")},
                                                           {.robot = W("blue")},
                                                           {.robot = W("green"),
                                                            .sonar_m = LIST(sonar_m),
                                                            .laser_m = LIST(laser_m),
                                                            .blobs = LIST(blobs),
                                                            .fiducials = LIST(fiducials)}};
static muster_Sense sense = {.process = W("p1"), .robots = LIST(percepts)};

static muster_Parcel parcels[FEW] = {{.box = W("red"), .number = 1, .letter = A_MAIL},
                                     {.box = W("red"), .number = 2, .letter = A_MAIL},
                                     {.box = W("red"), .number = 3, .letter = A_MAIL}};
static muster_Receipt receipts[FEW] = {{.agent = W("a")}, {.agent = W("b")}, {.agent = W("c")}};
static muster_Verdict verdicts[FEW] = {{.agent = W("a"), .reason = W("")},
                                       {.agent = W("b"), .reason = W("")},
                                       {.agent = W("c"), .reason = W("no")}};
static muster_Member members[FEW] = {A_MEMBER, A_MEMBER, A_MEMBER};
static muster_Membership memberships[FEW] = {{.group = W("g"), .agent = W("a"), .origin = W("b1")},
                                             {.group = W("g"), .agent = W(""), .origin = W("")},
                                             {.group = W("g"), .agent = W("c"), .origin = W("b1")}};
#define AN_OFFER                                                                      \
    {                                                                                 \
        .service = W("s"), .agent = W("a"), .attributes = W("k=v"), .origin = W("b1") \
    }
static muster_Offer offers[FEW] = {AN_OFFER, AN_OFFER, AN_OFFER};
static muster_Mail outside[FEW] = {A_MAIL, A_MAIL, A_MAIL};
static muster_Delivery delivery = {.process = W("p1"),
                                   .parcels = LIST(parcels),
                                   .receipts = LIST(receipts),
                                   .verdicts = LIST(verdicts),
                                   .members = LIST(members),
                                   .memberships = LIST(memberships),
                                   .offers = LIST(offers),
                                   .outside = LIST(outside),
                                   .broker = W("b1"),
                                   .glances = LIST(glances)};

static uint32_t seats[FEW] = {1, 4, 4}, slots[FEW] = {0, 0, 7};
static uint64_t serials[FEW] = {1, 2, 2}, numbers[FEW] = {1, 2, 3};
static muster_Mail letters[BUS_CIRCULAR_LETTERS + 1] = {A_MAIL, A_MAIL, A_MAIL};
static muster_Delivery circular = {.process = W(BUS_TO_ALL),
                                   .broker = W("b1"),
                                   .seats = LIST(seats),
                                   .serials = LIST(serials),
                                   .slots = LIST(slots),
                                   .numbers = LIST(numbers),
                                   .letters = LIST(letters)};

static muster_Entry entries[MU_PART_AGENTS + 1] = {
    {.name = W("red"), .home = W("")},
    {.name = W("blue"), .home = W("beta")},
};
static muster_Registration registration = {.wire = muster_WIRE,
                                           .process = W("p1"),
                                           .broker = W("main"),
                                           .host = W("here"),
                                           .agents = {._length = 2, ._buffer = entries}};
static char *processes[MU_PROCESSES_MAX + 1] = {W("p1"), W("p2"), W("p3")};
static muster_Roster roster = {
    .simulator = W("sim"), .broker = W("b1"), .processes = LIST(processes)};
static muster_RunCommand command = {
    .simulator = W("sim"), .source = W("operator"), .name = W("red"), .file = W(""), .when = W("")};
static muster_RunAnswer run_answer = {
    .simulator = W("sim"), .source = W("operator"), .reason = W("")};
static muster_RobotTotals totals[MU_ROBOTS_MAX + 1] = {
    {.robot = W("a")}, {.robot = W("b")}, {.robot = W("c")}};
static muster_ObjectPlace objects[MU_OBJECTS_MAX + 1] = {
    {.name = W("a")}, {.name = W("b")}, {.name = W("c")}};
static muster_RunStatus status = {.simulator = W("sim"),
                                  .hash = W("none"),
                                  .waits_for = W(""),
                                  .robots = LIST(totals),
                                  .objects = LIST(objects)};
static float corners_m[2 * 64 + 2] = {0, 1, 2};
static muster_Mount mounts[MU_SONARS_MAX + 1];
#define AN_OUTLINE                                        \
    {                                                     \
        .corners_m = {                                    \
            ._length = 2,                                 \
            ._maximum = sizeof corners_m / sizeof(float), \
            ._buffer = corners_m                          \
        }                                                 \
    }
#define A_FIGURE                                                                          \
    {                                                                                     \
        .name = W("red"), .color = W("red"), .shape = AN_OUTLINE, .sonars = LIST(mounts), \
        .lasers = LIST(mounts)                                                            \
    }
static muster_Outline walls[FEW] = {AN_OUTLINE, AN_OUTLINE, AN_OUTLINE};
static muster_Figure figures[FEW] = {A_FIGURE, A_FIGURE, A_FIGURE};
static muster_Figure things[MU_OBJECTS_MAX + 1] = {A_FIGURE, A_FIGURE, A_FIGURE};
static muster_Scene scene = {.simulator = W("sim"),
                             .world = W("arena.world"),
                             .walls = LIST(walls),
                             .robots = LIST(figures),
                             .objects = LIST(things)};
static muster_RobotView views[MU_ROBOTS_MAX + 1] = {{.name = W("a"), .goal = W("")},
                                                    {.name = W("b"), .goal = W("")},
                                                    {.name = W("c"), .goal = W("stay")}};
#define AN_ORDER                                                                         \
    {                                                                                    \
        .simulator = W("sim"), .source = W("operator"), .name = W("red"), .file = W(""), \
        .when = W("")                                                                    \
    }
static muster_RunCommand orders[MU_ORDERS_MAX + 1] = {AN_ORDER, AN_ORDER, AN_ORDER};
static muster_Mail strangers[MU_FRAME_MAILS_MAX + 1] = {A_MAIL, A_MAIL, A_MAIL};
static muster_Frame frame = {.simulator = W("sim"),
                             .robots = LIST(views),
                             .objects = LIST(objects),
                             .percepts = LIST(percepts),
                             .acts = LIST(acts),
                             .outside = LIST(strangers),
                             .orders = LIST(orders)};
static char *lines[FEW] = {W("a"), W("b"), W("c")};
static muster_Page page = {.broker = W("b1"), .lines = LIST(lines)};
static muster_Beacon beacon = {.broker = W("b1"), .incarnation = 1, .host = W("here")};
static muster_BrokerStatus broker_status = {.broker = W("b1")};
static muster_Counter counters[FEW] = {
    {.name = W("sent"), .value = 7}, {.name = W("box-full")}, {.name = W("expired")}};
static muster_PartStatus part_status = {
    .broker = W("b1"), .part = W("broker.mail"), .counters = LIST(counters)};
static muster_BrokerEvent broker_event = {
    .broker = W("b1"), .kind = W("dropped"), .agent = W("red"), .sender = W("blue")};

enum field_kind {
    A_NAME,   /* of an agent */
    A_WORD,   /* at most max bytes and at least one */
    A_TEXT,   /* at most max bytes */
    A_COUNT,  /* from 1 to INT64_MAX */
    A_LAST,   /* from 0 to INT64_MAX */
    A_DOUBLE, /* finite */
    A_SPEED,  /* anything: what is no number is the simulator's to refuse */
    A_FLOAT,  /* finite */
    A_LENGTH, /* of a sequence, at most max */
};

static const struct field {
    const char *label;
    bool (*check)(const void *sample);
    const void *sample;
    void *at;
    enum field_kind kind;
    size_t max;
} fields[] = {
#define MAIL(label, check, sample, m)                                                    \
    {label ".src", check, sample, &(m).src, A_NAME, 0},                                  \
        {label ".seq", check, sample, &(m).seq, A_COUNT, 0},                             \
        {label ".dst", check, sample, &(m).dst, A_WORD, MU_DST_MAX},                     \
        {label ".performative", check, sample, &(m).performative, A_TEXT, MU_FIELD_MAX}, \
        {label ".language", check, sample, &(m).language, A_TEXT, MU_FIELD_MAX},         \
        {label ".ontology", check, sample, &(m).ontology, A_TEXT, MU_FIELD_MAX},         \
        {label ".reply_with", check, sample, &(m).reply_with, A_TEXT, MU_FIELD_MAX},     \
        {label ".in_reply_to", check, sample, &(m).in_reply_to, A_TEXT, MU_FIELD_MAX},   \
        {label ".conversation", check, sample, &(m).conversation, A_TEXT, MU_FIELD_MAX}, \
    {                                                                                    \
        label ".content", check, sample, &(m).content, A_TEXT, MU_CONTENT_MAX            \
    }
#define MEMBER(label, check, sample, m)                                          \
    {label ".name", check, sample, &(m).name, A_NAME, 0},                        \
        {label ".process", check, sample, &(m).process, A_TEXT, MU_PROCESS_MAX}, \
        {label ".broker", check, sample, &(m).broker, A_TEXT, MU_FIELD_MAX},     \
    {                                                                            \
        label ".host", check, sample, &(m).host, A_TEXT, MU_FIELD_MAX            \
    }

    {"registration.broker", check_registration, &registration, &registration.broker, A_TEXT,
     MU_FIELD_MAX},
    {"registration.agents", check_registration, &registration, &registration.agents._length,
     A_LENGTH, MU_PART_AGENTS},
    {"registration.entry.home", check_registration, &registration, &entries[1].home, A_TEXT,
     MU_FIELD_MAX},
    {"registration.process", check_registration, &registration, &registration.process, A_WORD,
     MU_PROCESS_MAX},
    {"registration.host", check_registration, &registration, &registration.host, A_TEXT,
     MU_FIELD_MAX},

    {"up.process", check_up, &up, &up.process, A_WORD, MU_PROCESS_MAX},
    {"up.acts", check_up, &up, &up.acts._length, A_LENGTH, MU_LOCAL_AGENTS_MAX},
    {"up.acks", check_up, &up, &up.acks._length, A_LENGTH, MU_LOCAL_AGENTS_MAX},
    {"up.act.agent", check_up, &up, &acts[2].agent, A_NAME, 0},
    {"up.act.forward", check_up, &up, &acts[2].forward_m_s, A_SPEED, 0},
    {"up.act.turn", check_up, &up, &acts[2].turn_rad_s, A_SPEED, 0},
    {"up.act.rules", check_up, &up, &acts[2].rules, A_TEXT, RULES_MAX},
    {"up.act.goal", check_up, &up, &acts[2].goal, A_TEXT, MU_FIELD_MAX},
    {"up.act.diary", check_up, &up, &acts[2].diary, A_TEXT, MU_NOTE_MAX},
    {"up.act.mails", check_up, &up, &acts[2].mails._length, A_LENGTH, MU_OUTBOX_MAX},
    MAIL("up.act.mail", check_up, &up, mails[2]),
    {"up.glances", check_up, &up, &up.glances._length, A_LENGTH, MU_GLANCES_MAX},
    {"up.glance.asker", check_up, &up, &glances[2].asker, A_NAME, 0},
    {"up.glance.number", check_up, &up, &glances[2].number, A_COUNT, 0},
    {"up.glance.agent", check_up, &up, &glances[2].agent, A_NAME, 0},
    {"up.glance.line", check_up, &up, &glances[0].text, A_TEXT, MU_GLANCE_LINE_MAX},
    {"up.glance.shows", check_up, &up, &glances[2].text, A_TEXT, MU_GLANCE_BYTES_MAX - 1},
    {"up.first act.agent", check_up, &up, &acts[0].agent, A_NAME, 0},
    {"up.first mail.src", check_up, &up, &mails[0].src, A_NAME, 0},
    {"up.ack.box", check_up, &up, &acks[2].box, A_NAME, 0},
    {"up.first ack.box", check_up, &up, &acks[0].box, A_NAME, 0},

    {"sense.process", check_sense, &sense, &sense.process, A_WORD, MU_PROCESS_MAX},
    {"sense.robots", check_sense, &sense, &sense.robots._length, A_LENGTH, MU_LOCAL_AGENTS_MAX},
    {"sense.robot.robot", check_sense, &sense, &percepts[2].robot, A_NAME, 0},
    {"sense.first robot.robot", check_sense, &sense, &percepts[0].robot, A_NAME, 0},
    {"sense.robot.x", check_sense, &sense, &percepts[2].x_m, A_DOUBLE, 0},
    {"sense.robot.y", check_sense, &sense, &percepts[2].y_m, A_DOUBLE, 0},
    {"sense.robot.heading", check_sense, &sense, &percepts[2].heading_rad, A_DOUBLE, 0},
    {"sense.robot.forward", check_sense, &sense, &percepts[2].forward_m_s, A_DOUBLE, 0},
    {"sense.robot.turn", check_sense, &sense, &percepts[2].turn_rad_s, A_DOUBLE, 0},
    {"sense.robot.sonars", check_sense, &sense, &percepts[2].sonar_m._length, A_LENGTH,
     MU_SONARS_MAX},
    {"sense.robot.first sonar", check_sense, &sense, &sonar_m[0], A_FLOAT, 0},
    {"sense.robot.last sonar", check_sense, &sense, &sonar_m[2], A_FLOAT, 0},
    {"sense.robot.gps_x_m", check_sense, &sense, &percepts[2].gps_x_m, A_DOUBLE, 0},
    {"sense.robot.gps_y_m", check_sense, &sense, &percepts[2].gps_y_m, A_DOUBLE, 0},
    {"sense.robot.compass_rad", check_sense, &sense, &percepts[2].compass_rad, A_DOUBLE, 0},
    {"sense.robot.odometer_x_m", check_sense, &sense, &percepts[2].odometer_x_m, A_DOUBLE, 0},
    {"sense.robot.odometer_y_m", check_sense, &sense, &percepts[2].odometer_y_m, A_DOUBLE, 0},
    {"sense.robot.odometer_heading_rad", check_sense, &sense, &percepts[2].odometer_heading_rad,
     A_DOUBLE, 0},
    {"sense.robot.battery_share", check_sense, &sense, &percepts[2].battery_share, A_DOUBLE, 0},
    {"sense.robot.beams", check_sense, &sense, &percepts[2].laser_m._length, A_LENGTH,
     MU_BEAMS_MAX},
    {"sense.robot.first beam", check_sense, &sense, &laser_m[0], A_FLOAT, 0},
    {"sense.robot.last beam", check_sense, &sense, &laser_m[2], A_FLOAT, 0},
    {"sense.robot.blobs", check_sense, &sense, &percepts[2].blobs._length, A_LENGTH, MU_BLOBS_MAX},
    {"sense.robot.fiducials", check_sense, &sense, &percepts[2].fiducials._length, A_LENGTH,
     MU_FIDUCIALS_MAX},
    {"sense.robot.blob.bearing_rad", check_sense, &sense, &blobs[2].bearing_rad, A_DOUBLE, 0},
    {"sense.robot.blob.width_rad", check_sense, &sense, &blobs[2].width_rad, A_DOUBLE, 0},
    {"sense.robot.blob.range_m", check_sense, &sense, &blobs[2].range_m, A_DOUBLE, 0},
    {"sense.robot.fiducial.bearing_rad", check_sense, &sense, &fiducials[2].bearing_rad, A_DOUBLE,
     0},
    {"sense.robot.fiducial.range_m", check_sense, &sense, &fiducials[2].range_m, A_DOUBLE, 0},
    {"sense.robot.fiducial.heading_rad", check_sense, &sense, &fiducials[2].heading_rad, A_DOUBLE,
     0},

    {"delivery.process", check_delivery, &delivery, &delivery.process, A_WORD, MU_PROCESS_MAX},
    {"delivery.broker", check_delivery, &delivery, &delivery.broker, A_TEXT, MU_FIELD_MAX},
    {"delivery.parcel.box", check_delivery, &delivery, &parcels[2].box, A_NAME, 0},
    {"delivery.first parcel.box", check_delivery, &delivery, &parcels[0].box, A_NAME, 0},
    {"delivery.parcel.number", check_delivery, &delivery, &parcels[2].number, A_COUNT, 0},
    MAIL("delivery.parcel", check_delivery, &delivery, parcels[2].letter),
    {"delivery.glance.asker", check_delivery, &delivery, &glances[2].asker, A_NAME, 0},
    {"delivery.glance.agent", check_delivery, &delivery, &glances[1].agent, A_NAME, 0},
    {"delivery.receipt.agent", check_delivery, &delivery, &receipts[2].agent, A_NAME, 0},
    {"delivery.first receipt.agent", check_delivery, &delivery, &receipts[0].agent, A_NAME, 0},
    {"delivery.verdict.agent", check_delivery, &delivery, &verdicts[2].agent, A_TEXT, MU_FIELD_MAX},
    {"delivery.verdict.last_seq", check_delivery, &delivery, &verdicts[2].last_seq, A_LAST, 0},
    {"delivery.verdict.reason", check_delivery, &delivery, &verdicts[2].reason, A_TEXT,
     4 * MU_FIELD_MAX},
    {"delivery.first verdict.agent", check_delivery, &delivery, &verdicts[0].agent, A_TEXT,
     MU_FIELD_MAX},
    MEMBER("delivery.member", check_delivery, &delivery, members[2]),
    MEMBER("delivery.first member", check_delivery, &delivery, members[0]),
    {"delivery.membership.group", check_delivery, &delivery, &memberships[2].group, A_NAME, 0},
    {"delivery.membership.origin", check_delivery, &delivery, &memberships[2].origin, A_TEXT,
     MU_FIELD_MAX},
    {"delivery.offer.service", check_delivery, &delivery, &offers[2].service, A_NAME, 0},
    {"delivery.offer.agent", check_delivery, &delivery, &offers[2].agent, A_NAME, 0},
    {"delivery.first offer.agent", check_delivery, &delivery, &offers[0].agent, A_NAME, 0},
    {"delivery.offer.attributes", check_delivery, &delivery, &offers[2].attributes, A_TEXT,
     MU_ATTRIBUTES_MAX},
    {"delivery.offer.origin", check_delivery, &delivery, &offers[2].origin, A_TEXT, MU_FIELD_MAX},
    MAIL("delivery.outside", check_delivery, &delivery, outside[2]),
    {"delivery.serial", check_delivery, &delivery, &delivery.serial, A_LAST, 0},
    {"circular.serial", check_delivery, &circular, &serials[2], A_COUNT, 0},
    {"circular.first serial", check_delivery, &circular, &serials[0], A_COUNT, 0},
    {"circular.number", check_delivery, &circular, &numbers[2], A_COUNT, 0},
    {"circular.first number", check_delivery, &circular, &numbers[0], A_COUNT, 0},
    {"circular.letters", check_delivery, &circular, &circular.letters._length, A_LENGTH,
     BUS_CIRCULAR_LETTERS},
    MAIL("circular.letter", check_delivery, &circular, letters[2]),

    {"roster.simulator", check_roster, &roster, &roster.simulator, A_WORD, MU_PROCESS_MAX},
    {"roster.broker", check_roster, &roster, &roster.broker, A_TEXT, MU_NAME_MAX},
    {"roster.processes", check_roster, &roster, &roster.processes._length, A_LENGTH,
     MU_PROCESSES_MAX},
    {"roster.process", check_roster, &roster, &processes[2], A_WORD, MU_PROCESS_MAX},
    {"roster.first process", check_roster, &roster, &processes[0], A_WORD, MU_PROCESS_MAX},
    {"command.simulator", check_run_command, &command, &command.simulator, A_WORD, MU_PROCESS_MAX},
    {"command.source", check_run_command, &command, &command.source, A_TEXT, MU_PROCESS_MAX},
    {"command.name", check_run_command, &command, &command.name, A_TEXT, MU_FIELD_MAX},
    {"command.file", check_run_command, &command, &command.file, A_TEXT, 1023},
    {"command.when", check_run_command, &command, &command.when, A_TEXT, MU_CONDITION_MAX},
    {"command.x_m", check_run_command, &command, &command.x_m, A_DOUBLE, 0},
    {"command.y_m", check_run_command, &command, &command.y_m, A_DOUBLE, 0},
    {"command.heading_rad", check_run_command, &command, &command.heading_rad, A_DOUBLE, 0},
    {"command.force_x_n", check_run_command, &command, &command.force_x_n, A_DOUBLE, 0},
    {"command.force_y_n", check_run_command, &command, &command.force_y_n, A_DOUBLE, 0},
    {"command.torque_nm", check_run_command, &command, &command.torque_nm, A_DOUBLE, 0},
    {"command.time_s", check_run_command, &command, &command.time_s, A_DOUBLE, 0},
    {"command.rate", check_run_command, &command, &command.rate, A_DOUBLE, 0},
    {"answer.simulator", check_run_answer, &run_answer, &run_answer.simulator, A_WORD,
     MU_PROCESS_MAX},
    {"answer.source", check_run_answer, &run_answer, &run_answer.source, A_TEXT, MU_PROCESS_MAX},
    {"answer.reason", check_run_answer, &run_answer, &run_answer.reason, A_TEXT, 255},

    {"status.simulator", check_run_status, &status, &status.simulator, A_WORD, MU_PROCESS_MAX},
    {"status.hash", check_run_status, &status, &status.hash, A_TEXT, 64},
    {"status.waits_for", check_run_status, &status, &status.waits_for, A_TEXT, MU_CONTENT_MAX},
    {"status.robots", check_run_status, &status, &status.robots._length, A_LENGTH, MU_ROBOTS_MAX},
    {"status.robot", check_run_status, &status, &totals[2].robot, A_NAME, 0},
    {"status.objects", check_run_status, &status, &status.objects._length, A_LENGTH,
     MU_OBJECTS_MAX},
    {"status.object.name", check_run_status, &status, &objects[2].name, A_TEXT, MU_NAME_MAX},
    {"status.object.x_m", check_run_status, &status, &objects[2].x_m, A_DOUBLE, 0},
    {"status.object.y_m", check_run_status, &status, &objects[2].y_m, A_DOUBLE, 0},
    {"status.object.heading_rad", check_run_status, &status, &objects[0].heading_rad, A_DOUBLE, 0},
    {"status.first robot", check_run_status, &status, &totals[0].robot, A_NAME, 0},

    {"page.broker", check_page, &page, &page.broker, A_WORD, MU_PROCESS_MAX},
    {"page.line", check_page, &page, &lines[2], A_TEXT, 511},
    {"beacon.broker", check_beacon, &beacon, &beacon.broker, A_NAME, 0},
    {"beacon.incarnation", check_beacon, &beacon, &beacon.incarnation, A_COUNT, 0},
    {"beacon.host", check_beacon, &beacon, &beacon.host, A_TEXT, MU_FIELD_MAX},
    {"broker status.broker", check_broker_status, &broker_status, &broker_status.broker, A_WORD,
     MU_PROCESS_MAX},
    {"part status.broker", check_part_status, &part_status, &part_status.broker, A_WORD,
     MU_PROCESS_MAX},
    {"part status.part", check_part_status, &part_status, &part_status.part, A_NAME, 0},
    {"part status.counter", check_part_status, &part_status, &counters[0].name, A_NAME, 0},
    {"broker event.broker", check_broker_event, &broker_event, &broker_event.broker, A_WORD,
     MU_PROCESS_MAX},
    {"broker event.kind", check_broker_event, &broker_event, &broker_event.kind, A_TEXT,
     MU_FIELD_MAX},
    {"broker event.agent", check_broker_event, &broker_event, &broker_event.agent, A_NAME,
     MU_NAME_MAX},
    {"broker event.sender", check_broker_event, &broker_event, &broker_event.sender, A_NAME,
     MU_NAME_MAX},

#define REALS(label, check, sample, s, a, b, c)         \
    {label #a, check, sample, &(s).a, A_DOUBLE, 0},     \
        {label #b, check, sample, &(s).b, A_DOUBLE, 0}, \
    {                                                   \
        label #c, check, sample, &(s).c, A_DOUBLE, 0    \
    }
    {"scene.simulator", check_scene, &scene, &scene.simulator, A_WORD, MU_PROCESS_MAX},
    {"scene.world", check_scene, &scene, &scene.world, A_TEXT, 1023},
    REALS("scene.", check_scene, &scene, scene, min_x_m, min_y_m, max_x_m),
    {"scene.max_y_m", check_scene, &scene, &scene.max_y_m, A_DOUBLE, 0},
    {"scene.objects", check_scene, &scene, &scene.objects._length, A_LENGTH, MU_OBJECTS_MAX},
    {"scene.wall.radius_m", check_scene, &scene, &walls[2].radius_m, A_DOUBLE, 0},
    {"scene.wall.corner", check_scene, &scene, &corners_m[1], A_FLOAT, 0},
    {"scene.robot.name", check_scene, &scene, &figures[2].name, A_TEXT, MU_NAME_MAX},
    {"scene.robot.color", check_scene, &scene, &figures[2].color, A_TEXT, MU_FIELD_MAX},
    {"scene.robot.radius_m", check_scene, &scene, &figures[2].shape.radius_m, A_DOUBLE, 0},
    REALS("scene.robot.", check_scene, &scene, figures[0], x_m, y_m, heading_rad),
    {"scene.robot.sonars", check_scene, &scene, &figures[2].sonars._length, A_LENGTH,
     MU_SONARS_MAX},
    {"scene.robot.lasers", check_scene, &scene, &figures[2].lasers._length, A_LENGTH,
     MU_SONARS_MAX},
    REALS("scene.robot.mount.", check_scene, &scene, mounts[2], x_m, y_m, heading_rad),
    {"scene.robot.mount.fov_rad", check_scene, &scene, &mounts[2].fov_rad, A_DOUBLE, 0},
    {"scene.robot.mount.range_m", check_scene, &scene, &mounts[2].range_m, A_DOUBLE, 0},
    {"scene.object.name", check_scene, &scene, &things[2].name, A_TEXT, MU_NAME_MAX},

    {"frame.simulator", check_frame, &frame, &frame.simulator, A_WORD, MU_PROCESS_MAX},
    {"frame.robots", check_frame, &frame, &frame.robots._length, A_LENGTH, MU_ROBOTS_MAX},
    {"frame.robot.name", check_frame, &frame, &views[2].name, A_NAME, 0},
    REALS("frame.robot.", check_frame, &frame, views[2], x_m, y_m, heading_rad),
    REALS("frame.robot.", check_frame, &frame, views[2], forward_m_s, turn_rad_s, distance_m),
    REALS("frame.robot.", check_frame, &frame, views[0], command_forward_m_s, command_turn_rad_s,
          stalled_s),
    {"frame.objects", check_frame, &frame, &frame.objects._length, A_LENGTH, MU_OBJECTS_MAX},
    {"frame.object.x_m", check_frame, &frame, &objects[2].x_m, A_DOUBLE, 0},
    {"frame.percepts", check_frame, &frame, &frame.percepts._length, A_LENGTH, MU_ROBOTS_MAX},
    {"frame.percept.robot", check_frame, &frame, &percepts[2].robot, A_NAME, 0},
    {"frame.percept.beam", check_frame, &frame, &laser_m[2], A_FLOAT, 0},
    {"frame.acts", check_frame, &frame, &frame.acts._length, A_LENGTH, MU_FRAME_ACTS_MAX},
    {"frame.act.agent", check_frame, &frame, &acts[2].agent, A_NAME, 0},
    {"frame.robot.goal", check_frame, &frame, &views[2].goal, A_TEXT, MU_FIELD_MAX},
    {"frame.act.diary", check_frame, &frame, &acts[2].diary, A_TEXT, MU_NOTE_MAX},
    MAIL("frame.act.mail", check_frame, &frame, mails[2]),
    {"frame.outside", check_frame, &frame, &frame.outside._length, A_LENGTH, MU_FRAME_MAILS_MAX},
    {"frame.outside.src", check_frame, &frame, &strangers[2].src, A_NAME, 0},
    {"frame.orders", check_frame, &frame, &frame.orders._length, A_LENGTH, MU_ORDERS_MAX},
    {"frame.order.source", check_frame, &frame, &orders[2].source, A_TEXT, MU_PROCESS_MAX},
    {"frame.order.x_m", check_frame, &frame, &orders[2].x_m, A_DOUBLE, 0},
};

static unsigned wrong;

static void expect(const struct field *f, bool want, const char *what)
{
    if (f->check(f->sample) != want) {
        printf("\n    %s: %s was %s", f->label, what, want ? "refused" : "let through");
        wrong++;
    }
}

/* @return a name of that many bytes */
static char *text_of(size_t bytes)
{
    static char text[TEXT_MAX + 1];
    memset(text, 'n', TEXT_MAX);
    return text + TEXT_MAX - bytes;
}

static void try_text(const struct field *f, char *text, bool want, const char *what)
{
    char **at = f->at;
    char *kept = *at;
    *at = text;
    expect(f, want, what);
    *at = kept;
}

static void try_texts(const struct field *f)
{
    bool name = f->kind == A_NAME;
    size_t max = name ? MU_NAME_MAX : f->max;
    try_text(f, NULL, false, "NULL");
    try_text(f, W(""), f->kind == A_TEXT, "the empty string");
    try_text(f, text_of(max), true, "the longest string");
    try_text(f, text_of(max + 1), false, "a string too long");
    try_text(f, text_of(TEXT_MAX), false, "a very long string");
    try_text(f, W("9 lives"), !name, "a string that is no name");
}

static void try_real(const struct field *f, double value, bool want, const char *what)
{
    if (f->kind == A_FLOAT) {
        float kept = *(float *)f->at;
        *(float *)f->at = (float)value;
        expect(f, want, what);
        *(float *)f->at = kept;
    } else {
        double kept = *(double *)f->at;
        *(double *)f->at = value;
        expect(f, want, what);
        *(double *)f->at = kept;
    }
}

static void try_reals(const struct field *f)
{
    bool any = f->kind == A_SPEED;
    double most = f->kind == A_FLOAT ? (double)FLT_MAX : DBL_MAX;
    try_real(f, most, true, "the greatest number");
    try_real(f, -most, true, "the least number");
    try_real(f, (double)NAN, any, "NaN");
    try_real(f, (double)INFINITY, any, "infinity");
    try_real(f, -(double)INFINITY, any, "minus infinity");
}

static void try_count(const struct field *f)
{
    uint64_t kept = *(uint64_t *)f->at;
    *(uint64_t *)f->at = 0;
    expect(f, f->kind == A_LAST, "number 0");
    *(uint64_t *)f->at = INT64_MAX;
    expect(f, true, "the greatest count");
    *(uint64_t *)f->at = (uint64_t)INT64_MAX + 1;
    expect(f, false, "a count too great");
    *(uint64_t *)f->at = UINT64_MAX;
    expect(f, false, "the greatest number");
    *(uint64_t *)f->at = kept;
}

static void try_length(const struct field *f)
{
    uint32_t kept = *(uint32_t *)f->at;
    *(uint32_t *)f->at = 0;
    expect(f, true, "an empty list");
    *(uint32_t *)f->at = (uint32_t)f->max;
    expect(f, true, "the longest list");
    *(uint32_t *)f->at = (uint32_t)f->max + 1;
    expect(f, false, "a list too long");
    *(uint32_t *)f->at = kept;
}

/* Whole elements behind the first few, so that only its length is wrong with a long list. */
static int lists_fill(void)
{
    for (size_t i = FEW; i <= MU_OUTBOX_MAX; i++) {
        mails[i] = mails[0];
    }
    for (size_t i = FEW; i <= BUS_CIRCULAR_LETTERS; i++) {
        letters[i] = letters[0];
    }
    for (size_t i = FEW; i <= MU_LOCAL_AGENTS_MAX; i++) {
        acts[i] = acts[0];
        acks[i] = acks[0];
        percepts[i] = percepts[0];
    }
    for (size_t i = FEW; i <= MU_GLANCES_MAX; i++) {
        glances[i] = glances[0];
    }
    for (size_t i = 2; i <= MU_PART_AGENTS; i++) {
        entries[i] = entries[0];
    }
    for (size_t i = FEW; i <= MU_PROCESSES_MAX; i++) {
        processes[i] = processes[0];
    }
    for (size_t i = FEW; i <= MU_ROBOTS_MAX; i++) {
        totals[i] = totals[0];
        views[i] = views[0];
    }
    for (size_t i = FEW; i <= MU_OBJECTS_MAX; i++) {
        objects[i] = objects[0];
        things[i] = things[0];
    }
    for (size_t i = FEW; i <= MU_FRAME_MAILS_MAX; i++) {
        strangers[i] = strangers[0];
    }
    for (size_t i = FEW; i <= MU_ORDERS_MAX; i++) {
        orders[i] = orders[0];
    }
    return 0;
}

static void test_whole_samples_pass(void)
{
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        CU_ASSERT_TRUE(fields[i].check(fields[i].sample));
    }
}

static void test_each_field_is_checked(void)
{
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        const struct field *f = &fields[i];
        unsigned before = wrong;
        switch (f->kind) {
        case A_NAME:
        case A_WORD:
        case A_TEXT: try_texts(f); break;
        case A_COUNT:
        case A_LAST: try_count(f); break;
        case A_DOUBLE:
        case A_SPEED:
        case A_FLOAT: try_reals(f); break;
        case A_LENGTH: try_length(f); break;
        }
        CU_ASSERT_EQUAL(wrong, before);
        CU_ASSERT_TRUE(f->check(f->sample));
    }
}

/* The broker says why it refuses such a name; so it must get to see it. */
static void test_bad_names_of_agents_reach_the_broker(void)
{
    static char long_name[10001];
    memset(long_name, 'n', sizeof long_name - 1);
    char *const names[] = {W(""),   W("9"), W("a b"),  W("a\"b"),   W("a\nb"),
                           W("a*"), W("-"), W("\xff"), W("broker"), long_name};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        entries[0].name = names[i];
        CU_ASSERT_TRUE(check_registration(&registration));
    }
    entries[0].name = W("red");
}

static void test_words_about_trips(void)
{
    muster_Trip t = {.word = muster_TRIP_NEW,
                     .agent = W("ruby"),
                     .asker = W("red"),
                     .host = W("north"),
                     .process = W(""),
                     .reason = W(""),
                     .text = W("capsule")};
    up.trips = (dds_sequence_muster_Trip){._length = 1, ._maximum = 1, ._buffer = &t};
    CU_ASSERT_TRUE(check_up(&up));
    t.asker = W("");
    CU_ASSERT_FALSE(check_up(&up));
    t.word = muster_TRIP_DEPOSIT;
    CU_ASSERT_TRUE(check_up(&up));
    t.asker = NULL;
    CU_ASSERT_FALSE(check_up(&up));
    t.asker = W("red");
    t.state = muster_STATE_ABSENT + 1;
    CU_ASSERT_FALSE(check_up(&up));
    t.state = muster_STATE_STANDBY;
    t.word = muster_TRIP_NEW + 1;
    CU_ASSERT_FALSE(check_up(&up));
    up.trips._length = up.trips._maximum = 0;
}

/* Who has had the last word on a mail sends its number alone to another broker. */
static void test_mail_that_is_over_goes_to_nobody(void)
{
    mails[2].dst = parcels[2].letter.dst = W("");
    CU_ASSERT_FALSE(check_up(&up));
    mails[2].again = parcels[2].letter.again = true;
    CU_ASSERT_TRUE(check_up(&up));
    CU_ASSERT_FALSE(check_delivery(&delivery)); /* no broker passes it on */
    mails[2].dst = parcels[2].letter.dst = W("blue");
    mails[2].again = parcels[2].letter.again = false;
}

/* The lists of a circular are of the same boxes, and whoever looks for its seat finds all of it. */
static void test_boxes_of_circulars(void)
{
    uint32_t *const lengths[] = {&circular.seats._length, &circular.serials._length,
                                 &circular.slots._length, &circular.numbers._length};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        *lengths[i] = FEW - 1;
        CU_ASSERT_FALSE(check_delivery(&circular));
        *lengths[i] = 0;
        CU_ASSERT_FALSE(check_delivery(&circular));
        *lengths[i] = FEW;
        CU_ASSERT_TRUE(check_delivery(&circular));
    }
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        *lengths[i] = 0;
    }
    CU_ASSERT_TRUE(check_delivery(&circular)); /* for nobody */
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        *lengths[i] = FEW;
    }
    static const struct {
        uint32_t seats[FEW];
        bool good;
    } rows[] = {{{0, 0, 0}, true},
                {{1, 2, UINT32_MAX}, true},
                {{2, 1, 3}, false},
                {{1, 3, 2}, false},
                {{UINT32_MAX, 0, 1}, false}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        circular.seats._buffer = (uint32_t *)(uintptr_t)rows[i].seats;
        CU_ASSERT_EQUAL(check_delivery(&circular), rows[i].good);
    }
    circular.seats._buffer = seats;
}

/* Corners come in pairs, and an outline has no more than 64. */
static void test_outlines(void)
{
    static const struct {
        uint32_t numbers;
        bool good;
    } cases[] = {{0, true}, {1, false}, {2, true}, {127, false}, {128, true}, {129, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        walls[0].corners_m._length = cases[i].numbers;
        CU_ASSERT_EQUAL(check_scene(&scene), cases[i].good);
    }
    walls[0].corners_m._length = 130;
    CU_ASSERT_FALSE(check_scene(&scene));
    walls[0].corners_m._length = 2;
    mounts[2].beams = MU_BEAMS_MAX + 1;
    CU_ASSERT_FALSE(check_scene(&scene));
    mounts[2].beams = MU_BEAMS_MAX;
    CU_ASSERT_TRUE(check_scene(&scene));
    orders[1].order = muster_RUN_HOLD + 1;
    CU_ASSERT_FALSE(check_frame(&frame));
    orders[1].order = muster_RUN_HOLD;
    CU_ASSERT_TRUE(check_frame(&frame));
}

static void test_every_topic_has_its_check(void)
{
    bool (*const checks[BUS_TOPICS])(const void *) = {
        [BUS_REGISTRATION] = check_registration,
        [BUS_UP] = check_up,
        [BUS_SENSE] = check_sense,
        [BUS_DELIVERY] = check_delivery,
        [BUS_ROSTER] = check_roster,
        [BUS_RUN_COMMAND] = check_run_command,
        [BUS_RUN_ANSWER] = check_run_answer,
        [BUS_RUN_STATUS] = check_run_status,
        [BUS_PAGES] = check_page,
        [BUS_BROKER_STATUS] = check_broker_status,
        [BUS_PART_STATUS] = check_part_status,
        [BUS_BROKER_EVENT] = check_broker_event,
        [BUS_BEACON] = check_beacon,
        [BUS_SCENE] = check_scene,
        [BUS_FRAME] = check_frame,
    };
    for (size_t i = 0; i < BUS_TOPICS; i++) {
        CU_ASSERT(topic_table[i].check != NULL && topic_table[i].check == checks[i]);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"whole samples pass", test_whole_samples_pass},
        {"each field is checked", test_each_field_is_checked},
        {"bad names of agents reach the broker", test_bad_names_of_agents_reach_the_broker},
        {"words about trips", test_words_about_trips},
        {"mail that is over goes to nobody", test_mail_that_is_over_goes_to_nobody},
        {"boxes of circulars", test_boxes_of_circulars},
        {"outlines", test_outlines},
        {"every topic has its check", test_every_topic_has_its_check},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"bus/check", lists_fill, NULL, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
