/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Deliveries that come by two ways, in the broker's order.  This test is the broker: its writers
 * share the participant of the process under test, so that what is written has come.
 */
#include "capture.h"
#include "core/random.h"
#include "core/text.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LIFE = 7, SEAT = 5, BOXES_MAX = 80 };

static mu_process process;
static struct bus_writer own, multicasts;
static char heard_buffer[8192];
static struct mu_text heard;
static char text[8]; /* of all letters */

static int network_begin(void)
{
    const struct bus_options options = {
        .domain = 100 + (int)(getpid() % 100), .place = BUS_AGENT, .name = "inbox"};
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    process_take_memory(&process, 0, 0);
    mu_text_copy(process.name, sizeof process.name, "p1");
    return bus_open(&process.bus, &options) != MU_OK ||
           bus_reader_open(&process.bus, BUS_DELIVERY, "p1", &process.delivery) != MU_OK ||
           bus_reader_open_deep(&process.bus, BUS_DELIVERY, BUS_TO_ALL, INBOX_DEPTH,
                                &process.multicasts) != MU_OK ||
           bus_writer_open(&process.bus, BUS_DELIVERY, "p1", NULL, &own) != MU_OK ||
           bus_writer_open(&process.bus, BUS_DELIVERY, BUS_TO_ALL, NULL, &multicasts) != MU_OK;
}

static int network_end(void)
{
    bus_close(&process.bus);
    return 0;
}

static void join(const char *name)
{
    static const struct mu_handlers none;
    mu_agent *a = NULL;
    capture_begin();
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &a, name, MU_KIND_AGENT, 0, &none), MU_OK);
    capture_end();
}

/* The process knows its broker, and nothing has come. */
static void begin(void)
{
    enum bus_life life;
    process.mail = NULL;
    while (bus_next(&process.delivery, &life) || bus_next(&process.multicasts, &life)) {
    }
    memset(&process.inbox, 0, sizeof process.inbox);
    inbox_init(&process.inbox);
    mu_text_copy(process.link.broker, sizeof process.link.broker, "main");
    process.link.incarnation = LIFE;
    process.steps = PROCESS_FREE;
    process.probes.due_count = 0;
    mu_text_init(&heard, heard_buffer, sizeof heard_buffer);
    if (process.agent_count == 0) {
        join("red");
        join("blue");
    }
    for (uint32_t i = 0; i < process.agent_count; i++) {
        process.agents[i].name_state = NAME_ACCEPTED;
        process.agents[i].accepted_serial = 0;
    }
}

/* --- the broker ------------------------------------------------------------------------------- */

static muster_Delivery delivery(uint32_t seat, uint64_t serial)
{
    return (muster_Delivery){.process = words("p1"),
                             .broker = words("main"),
                             .broker_incarnation = LIFE,
                             .step = muster_STEP_NOW,
                             .seat = seat,
                             .serial = serial};
}

static void mail_write(muster_Delivery d, uint64_t number)
{
    muster_Parcel item = {.box = words("red"), .number = number};
    item.letter = letter("green", number, "red", text);
    d.parcels._buffer = &item;
    d.parcels._length = d.parcels._maximum = number > 0;
    CU_ASSERT_EQUAL_FATAL(bus_write(&own, &d), MU_OK);
}

/* A Delivery for this process alone, with the mail of that number. */
static void mail(uint64_t serial, uint64_t number)
{
    mail_write(delivery(SEAT, serial), number);
}

/* Boxes of a circular, each with a serial, and a number of its first letter. */
struct boxes {
    uint32_t count;
    uint32_t seats[BOXES_MAX], slots[BOXES_MAX];
    uint64_t serials[BOXES_MAX], numbers[BOXES_MAX];
};

static void box_add(struct boxes *to, uint32_t seat, uint64_t serial, uint32_t slot,
                    uint64_t number)
{
    to->seats[to->count] = seat;
    to->slots[to->count] = slot;
    to->serials[to->count] = serial;
    to->numbers[to->count++] = number;
}

static void circular_write(const char *broker, uint64_t life, struct boxes *to, uint32_t letters)
{
    muster_Mail mails[BUS_CIRCULAR_LETTERS];
    muster_Delivery d = {.process = words(BUS_TO_ALL),
                         .broker = words(broker),
                         .broker_incarnation = life,
                         .step = muster_STEP_NOW};
    for (uint32_t i = 0; i < letters; i++) {
        mails[i] = letter("green", 1 + i, "all", text);
    }
    d.seats._buffer = to->seats;
    d.serials._buffer = to->serials;
    d.slots._buffer = to->slots;
    d.numbers._buffer = to->numbers;
    d.letters._buffer = mails;
    d.seats._length = d.serials._length = d.slots._length = d.numbers._length = to->count;
    d.letters._length = letters;
    CU_ASSERT_EQUAL_FATAL(bus_write(&multicasts, &d), MU_OK);
}

/* One for this process and for its neighbours, with one letter to red. */
static void circular_to(uint32_t seat, uint64_t serial, uint64_t number)
{
    struct boxes to = {0};
    box_add(&to, seat - 1, serial + 100, 0, number + 100);
    box_add(&to, seat, serial, 0, number);
    box_add(&to, seat + 1, serial + 200, 0, number + 200);
    circular_write("main", LIFE, &to, 1);
}

static void circular(uint64_t serial, uint64_t number)
{
    circular_to(SEAT, serial, number);
}

/* --- the process ------------------------------------------------------------------------------ */

static void note(const muster_Delivery *d)
{
    for (uint32_t i = 0; i < d->parcels._length; i++) {
        const muster_Parcel *item = &d->parcels._buffer[i];
        CU_ASSERT_STRING_EQUAL(item->letter.content, text);
        mu_text_format(&heard, "%s#%llu ", item->box, (unsigned long long)item->number);
    }
    if (d->step != muster_STEP_NOW) {
        mu_text_format(&heard, "step %lld ", (long long)d->step);
    }
    if (d->parcels._length == 0) {
        mu_text_add(&heard, "- ");
    }
}

/* As a process does in a round.  @return what is handed over now, and whether something is missing
 */
static const char *take(void)
{
    mu_text_clear(&heard);
    inbox_fill(&process);
    inbox_next(&process);
    while (process.mail) {
        note(process.mail);
        inbox_next(&process);
    }
    if (inbox_lacks(&process)) {
        mu_text_add(&heard, "...");
    }
    return heard.at;
}

/* What is missing has been for as long as it may. */
static void patience_end(void)
{
    CU_ASSERT_TRUE_FATAL(inbox_lacks(&process));
    process.inbox.lacks_ns -= INBOX_PATIENCE_NS;
}

/* The first Delivery: the process has its seat. */
static void seat_take(void)
{
    begin();
    mail(1, 1);
    READS(take(), "red#1 ");
}

/* Expects these mails and nothing else. */
static void mails_expect(uint64_t first, uint64_t last)
{
    static char buffer[8192];
    struct mu_text wanted;
    mu_text_init(&wanted, buffer, sizeof buffer);
    for (uint64_t number = first; number <= last; number++) {
        mu_text_format(&wanted, "red#%llu ", (unsigned long long)number);
    }
    READS(take(), wanted.at);
}

/* --- order ------------------------------------------------------------------------------------ */

static void test_both_ways_are_one_row(void)
{
    seat_take();
    circular(2, 2);
    circular(3, 3);
    mail(4, 4);
    circular(5, 5);
    mails_expect(2, 5);
    CU_ASSERT_EQUAL(process.inbox.count, 0);
}

static void test_what_comes_too_early_waits(void)
{
    seat_take();
    circular(3, 3);
    READS(take(), "...");
    READS(take(), "...");
    mail(2, 2);
    READS(take(), "red#2 red#3 ");
    mail(5, 5);
    mail(6, 6);
    circular(7, 7);
    READS(take(), "...");
    circular(4, 4);
    mails_expect(4, 7);
}

static void test_patience_ends(void)
{
    seat_take();
    mail(4, 4);
    READS(take(), "...");
    circular(3, 3);
    circular(7, 7);
    READS(take(), "...");
    patience_end();
    READS(take(), "red#3 red#4 ..."); /* what lacks now has a patience of its own */
    READS(take(), "...");
    patience_end();
    READS(take(), "red#7 ");
    circular(8, 8);
    READS(take(), "red#8 ");
}

/* The box's numbers say what is to be done with it; the count does not go back for it. */
static void test_what_was_given_up_comes_late(void)
{
    seat_take();
    circular(3, 3);
    READS(take(), "...");
    patience_end();
    READS(take(), "red#3 ");
    mail(2, 2);
    READS(take(), "red#2 ");
    circular(4, 4);
    READS(take(), "red#4 ");
    CU_ASSERT_EQUAL(process.inbox.serial, 4);
    circular(4, 4);
    READS(take(), "red#4 ");
    circular(5, 5);
    READS(take(), "red#5 ");
}

/* Every way that a row can be torn into two, and shuffled: it is put together again. */
static void test_any_order_is_mended(void)
{
    enum { ROUNDS = 200, ROW = INBOX_EACH / 2 };
    struct mu_random random;
    mu_random_seed(&random, suite_setting("MUSTER_SEED", 1), "inbox");
    seat_take();
    uint64_t last = 1;
    for (int round = 0; round < ROUNDS; round++) {
        uint64_t row[ROW];
        for (uint32_t i = 0; i < ROW; i++) {
            row[i] = last + 1 + i;
        }
        for (uint32_t i = ROW - 1; i > 0; i--) {
            uint32_t other = (uint32_t)mu_random_between(&random, 0, i);
            uint64_t kept = row[i];
            row[i] = row[other];
            row[other] = kept;
        }
        for (uint32_t i = 0; i < ROW; i++) {
            (mu_random_between(&random, 0, 1) ? mail : circular)(row[i], row[i]);
            inbox_fill(&process);
        }
        mails_expect(last + 1, last + ROW);
        last += ROW;
    }
}

static void test_the_mail_of_a_step_waits_too(void)
{
    seat_take();
    process.steps = PROCESS_LIVED;
    muster_Delivery d = delivery(SEAT, 3);
    d.step = 11;
    mail_write(d, 3);
    READS(take(), "...");
    circular(2, 2);
    READS(take(), "red#2 red#3 step 11 ");
}

/* --- whose ------------------------------------------------------------------------------------ */

static void test_circulars_of_others(void)
{
    struct boxes to = {0};
    seat_take();
    box_add(&to, SEAT, 2, 0, 2);
    circular_write("other", LIFE, &to, 1);
    circular_write("main", LIFE - 1, &to, 1);
    circular_write("main", LIFE + 1, &to, 1);
    circular_to(SEAT - 2, 2, 2);
    circular_to(SEAT + 2, 2, 2);
    READS(take(), "");
    CU_ASSERT_EQUAL(process.inbox.count, 0);
    CU_ASSERT_EQUAL(process.link.incarnation, LIFE); /* nobody is followed for it */
    circular(2, 2);
    READS(take(), "red#2 ");
}

static void test_who_has_no_seat_is_not_meant(void)
{
    struct boxes to = {0};
    begin();
    circular(1, 1);
    box_add(&to, 0, 1, 0, 1);
    circular_write("main", 0, &to, 1);
    READS(take(), "");
    mail(2, 1);
    READS(take(), "red#1 ");
}

static void test_boxes_of_one_process(void)
{
    struct boxes to = {0};
    seat_take();
    box_add(&to, SEAT - 1, 2, 1, 9);
    box_add(&to, SEAT, 2, 0, 2);
    box_add(&to, SEAT, 2, 1, 5);
    box_add(&to, SEAT, 2, 2, 7); /* nobody */
    box_add(&to, SEAT, 2, UINT32_MAX, 7);
    box_add(&to, SEAT + 1, 2, 0, 9);
    circular_write("main", LIFE, &to, 3);
    READS(take(), "red#2 red#3 red#4 blue#5 blue#6 blue#7 ");
}

static void test_a_circular_without_letters_counts(void)
{
    struct boxes to = {0};
    seat_take();
    box_add(&to, SEAT, 2, 0, 2);
    circular_write("main", LIFE, &to, 0);
    READS(take(), "- ");
    circular(3, 2);
    READS(take(), "red#2 ");
}

/* No broker writes so many boxes; and what nobody has read need not fit. */
static void test_limit_boxes_of_one_process(void)
{
    struct boxes to = {0};
    seat_take();
    for (uint32_t i = 0; i < BOXES_MAX; i++) {
        box_add(&to, SEAT, 2, i % 2, 2);
    }
    circular_write("main", LIFE, &to, BUS_CIRCULAR_LETTERS);
    inbox_next(&process);
    CU_ASSERT_PTR_NOT_NULL_FATAL(process.mail);
    CU_ASSERT_EQUAL(process.mail->parcels._length, BUS_CIRCULAR_BOXES * BUS_CIRCULAR_LETTERS);
    mail(3, 2);
    READS(take(), "red#2 ");
}

/* --- places ----------------------------------------------------------------------------------- */

static void test_a_new_place_begins_a_new_count(void)
{
    seat_take();
    circular(2, 2);
    mail_write(delivery(SEAT + 3, 1), 3);
    READS(take(), "red#2 red#3 ");
    circular(3, 4); /* the old one */
    circular_to(SEAT + 3, 2, 4);
    READS(take(), "red#4 ");
}

/* What waits in the old count goes before: what that lacks will not come any more. */
static void test_a_new_place_ends_the_old_one(void)
{
    seat_take();
    mail(4, 4);
    circular(3, 3);
    READS(take(), "...");
    mail_write(delivery(SEAT + 3, 1), 5);
    mail_write(delivery(SEAT + 3, 2), 6);
    circular_to(SEAT + 3, 3, 7);
    READS(take(), "red#3 red#4 red#5 red#6 ");
    circular_to(SEAT + 3, 3, 7);
    READS(take(), "red#7 ");
}

/* The old one does not come back, however late something of it comes. */
static void test_an_old_place_says_nothing_more(void)
{
    seat_take();
    mail_write(delivery(SEAT + 3, 1), 2);
    READS(take(), "red#2 ");
    mail(2, 9);
    circular_to(SEAT + 3, 2, 3);
    READS(take(), "red#3 ");
}

static void test_a_broker_that_is_back_begins_a_new_count(void)
{
    seat_take();
    circular(3, 3);
    READS(take(), "...");
    muster_Delivery d = delivery(SEAT, 1);
    d.broker_incarnation = LIFE + 1;
    mail_write(d, 1);
    READS(take(), "red#1 ");
    CU_ASSERT_EQUAL(process.link.incarnation, LIFE + 1);
    CU_ASSERT_EQUAL(process.inbox.count, 0); /* what waited was of the earlier life */
    circular(2, 2);
    READS(take(), "");
    process.agents[0].name_state = NAME_ACCEPTED; /* there, too */
    struct boxes to = {0};
    box_add(&to, SEAT, 2, 0, 2);
    circular_write("main", LIFE + 1, &to, 1);
    READS(take(), "red#2 ");
}

/* Back at a broker, which goes on in its count. */
static void test_there_and_back(void)
{
    seat_take();
    mu_text_copy(process.link.broker, sizeof process.link.broker, "other");
    process.link.incarnation = LIFE + 9;
    muster_Delivery d = delivery(SEAT, 40);
    d.broker = words("other");
    d.broker_incarnation = LIFE + 9;
    mail_write(d, 21);
    circular(2, 2);
    READS(take(), "red#21 ");
    mu_text_copy(process.link.broker, sizeof process.link.broker, "main");
    process.link.incarnation = LIFE;
    circular(3, 2); /* it does not know its seat there any more */
    mail(4, 3);
    READS(take(), "red#3 ");
    circular(5, 4);
    READS(take(), "red#4 ");
}

/* What another broker says waits for nothing, and is in nobody's way. */
static void test_another_broker_is_not_waited_for(void)
{
    seat_take();
    muster_Delivery d = delivery(SEAT, 9);
    d.broker = words("other");
    d.broker_incarnation = LIFE + 9;
    mail_write(d, 21);
    circular(2, 2);
    READS(take(), "red#2 ");
}

/* ... however much it has to say. */
static void test_another_broker_does_not_prolong_patience(void)
{
    seat_take();
    circular(3, 3);
    READS(take(), "...");
    uint64_t since_ns = process.inbox.lacks_ns;
    muster_Delivery d = delivery(SEAT, 9);
    d.broker = words("other");
    d.broker_incarnation = LIFE + 9;
    mail_write(d, 21);
    READS(take(), "...");
    CU_ASSERT_EQUAL(process.inbox.lacks_ns, since_ns);
    patience_end();
    READS(take(), "red#3 ");
}

/* --- room ------------------------------------------------------------------------------------- */

static void glance_write(uint64_t number)
{
    muster_Delivery d = delivery(SEAT, 0);
    muster_Glance g = {.word = muster_GLANCE_ASK,
                       .asker = words("operator-1"),
                       .number = number,
                       .agent = words("red"),
                       .text = words("(facts)")};
    d.glances._buffer = &g;
    d.glances._length = d.glances._maximum = 1;
    CU_ASSERT_EQUAL_FATAL(bus_write(&own, &d), MU_OK);
}

static void test_who_only_looks_does_not_wait(void)
{
    seat_take();
    circular(3, 3);
    glance_write(1);
    READS(take(), "...");
    glance_write(2);
    READS(take(), "...");
    CU_ASSERT_EQUAL(process.probes.due_count, 2);
}

/* Expects the Deliveries of these serials, in order. */
static void serials_expect(uint64_t first, uint64_t last)
{
    for (uint64_t serial = first; serial <= last; serial++) {
        inbox_next(&process);
        CU_ASSERT_PTR_NOT_NULL_FATAL(process.mail);
        CU_ASSERT_EQUAL(process.inbox.serial, serial);
    }
}

/* More than there is room for lies in the reader until there is. */
static void test_limit_what_waits(void)
{
    seat_take();
    for (uint64_t serial = 2; serial < 2 + 3 * INBOX_MAX; serial++) {
        mail(serial, serial);
    }
    inbox_fill(&process);
    CU_ASSERT_EQUAL(process.inbox.count, INBOX_EACH);
    serials_expect(2, 1 + 3 * INBOX_MAX);
    READS(take(), "");
}

/* Who was stopped for a while finds one way behind the other, and a window of mail in them. */
static void test_one_way_lies_behind_the_other(void)
{
    seat_take();
    for (uint64_t serial = 2; serial < 2 + MU_WINDOW_MAX; serial++) {
        (serial % 2 ? mail : circular)(serial, serial);
    }
    mails_expect(2, 1 + MU_WINDOW_MAX);
}

/* What is missing comes by the one way while more than there is room for waits on the other. */
static void test_limit_each_way_has_its_room(void)
{
    for (int ways = 0; ways < 2; ways++) {
        seat_take();
        for (uint64_t serial = 3; serial < 3 + 2 * INBOX_EACH; serial++) {
            (ways ? mail : circular)(serial, serial);
        }
        READS(take(), "...");
        CU_ASSERT_EQUAL(process.inbox.count, INBOX_EACH);
        (ways ? circular : mail)(2, 2);
        serials_expect(2, 2 + 2 * INBOX_EACH);
        READS(take(), "");
    }
}

static bool wakes(int fd)
{
    struct pollfd wait = {.fd = fd, .events = POLLIN};
    return poll(&wait, 1, 0) == 1;
}

/* A program with a poll loop of its own sleeps while something is missing, and wakes for it. */
static void test_who_polls_wakes_for_what_was_missing(void)
{
    enum bus_life life;
    seat_take();
    int fd = mu_process_wake_fd(&process);
    CU_ASSERT_TRUE_FATAL(fd >= 0);
    for (uint64_t serial = 3; serial < 3 + 2 * INBOX_EACH; serial++) {
        circular(serial, serial);
    }
    CU_ASSERT_TRUE(wakes(fd));
    READS(take(), "...");
    CU_ASSERT_PTR_NULL(bus_next(&process.delivery, &life));
    bus_wait(&process.bus, 1, 0);
    CU_ASSERT_FALSE(wakes(fd));
    mail(2, 2);
    CU_ASSERT_TRUE(wakes(fd));
    mails_expect(2, 2 + 2 * INBOX_EACH);
}

int main(void)
{
    CU_TestInfo order[] = {
        {"both ways are one row", test_both_ways_are_one_row},
        {"what comes too early waits", test_what_comes_too_early_waits},
        {"patience ends", test_patience_ends},
        {"what was given up comes late", test_what_was_given_up_comes_late},
        {"any order is mended", test_any_order_is_mended},
        {"the mail of a step waits, too", test_the_mail_of_a_step_waits_too},
        CU_TEST_INFO_NULL,
    };
    CU_TestInfo whose[] = {
        {"multicasts of others", test_circulars_of_others},
        {"who has no seat is not meant", test_who_has_no_seat_is_not_meant},
        {"boxes of one process", test_boxes_of_one_process},
        {"a circular without letters counts", test_a_circular_without_letters_counts},
        {"limit: boxes of one process", test_limit_boxes_of_one_process},
        {"a new place begins a new count", test_a_new_place_begins_a_new_count},
        {"a new place ends the old one", test_a_new_place_ends_the_old_one},
        {"an old place says nothing more", test_an_old_place_says_nothing_more},
        {"a broker that is back", test_a_broker_that_is_back_begins_a_new_count},
        {"there and back", test_there_and_back},
        {"another broker is not waited for", test_another_broker_is_not_waited_for},
        {"another broker does not prolong patience", test_another_broker_does_not_prolong_patience},
        CU_TEST_INFO_NULL,
    };
    CU_TestInfo room[] = {
        {"who only looks does not wait", test_who_only_looks_does_not_wait},
        {"limit: what waits", test_limit_what_waits},
        {"one way lies behind the other", test_one_way_lies_behind_the_other},
        {"limit: each way has its room", test_limit_each_way_has_its_room},
        {"who polls wakes for what was missing", test_who_polls_wakes_for_what_was_missing},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/inbox: order", network_begin, NULL, NULL, NULL, order},
                             {"runtime/inbox: whose", NULL, NULL, NULL, NULL, whose},
                             {"runtime/inbox: room", NULL, network_end, NULL, NULL, room},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
