/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Orders of pages to the world: what goes out, who is told what became of it, what waits.  This
 * test is the simulator: its reader and writer share the participant of the hands under test.
 */
#include "core/clock.h"
#include "muster/memory.h"
#include "samples.h"
#include "suite.h"
#include "told.h"
#include "web/web.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 5000000000u;
static const uint64_t SECOND_NS = 1000000000u;

enum { SEEN_MAX = 128, NUMBER = 7 };

static struct bus bus;
static struct bus_reader commands;
static struct bus_writer answers;
static struct board board;
static struct viewers viewers;
static struct watch watch;
static struct hands hands;
static struct viewer *asker, *other;

/* What the simulator has got. */
static struct seen {
    uint64_t seq, due_ns;
    muster_RunOrder order;
    char simulator[MU_PROCESS_MAX + 1], source[MU_PROCESS_MAX + 1], name[MU_FIELD_MAX + 1];
    char when[MU_CONDITION_MAX + 1];
} seen[SEEN_MAX];
static size_t seen_count;

static void commands_take(void)
{
    enum bus_life life;
    for (const muster_RunCommand *c; (c = bus_next(&commands, &life));) {
        if (life != BUS_DATA || seen_count == SEEN_MAX) {
            continue;
        }
        struct seen *s = &seen[seen_count++];
        *s = (struct seen){.seq = c->seq, .due_ns = c->due_ns, .order = c->order};
        snprintf(s->simulator, sizeof s->simulator, "%s", c->simulator);
        snprintf(s->source, sizeof s->source, "%s", c->source);
        snprintf(s->name, sizeof s->name, "%s", c->name);
        snprintf(s->when, sizeof s->when, "%s", c->when);
    }
}

/* Waits until the simulator has so many.  @return the last of them */
static const struct seen *seen_await(size_t count)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (seen_count < count && mu_clock_ns() < until_ns) {
        bus_wait(&bus, 1, 5000000);
        commands_take();
    }
    CU_ASSERT_EQUAL_FATAL(seen_count, count);
    return &seen[count - 1];
}

static void answer(const char *source, uint64_t seq, muster_RunOutcome result, const char *reason)
{
    muster_RunAnswer a = {.simulator = words("simulator.1"),
                          .source = words(source),
                          .seq = seq,
                          .step = 42,
                          .result = result,
                          .reason = words(reason)};
    CU_ASSERT_EQUAL_FATAL(bus_write(&answers, &a), MU_OK);
}

/* Rounds at about now until the viewer has something to read, or for a moment. */
static const char *round_and_hear(struct viewer *v)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (v->stream.queue_len == 0 && mu_clock_ns() < until_ns) {
        bus_wait(&bus, 1, 5000000);
        hands_round(&hands, mu_clock_ns());
    }
    return told(v);
}

static void simulator_is(const char *name, muster_RunState state)
{
    muster_RunStatus status = {
        .simulator = words(name), .state = state, .hash = words(""), .waits_for = words("")};
    run_json_take(&watch.run, &status);
    snprintf(watch.simulator, sizeof watch.simulator, "%s", name);
}

/* A run lives, nothing waits, and both viewers have read. */
static void begin(void)
{
    memset(hands.asks, 0, sizeof hands.asks);
    simulator_is("simulator.1", muster_RUN_RUNNING);
    (void)told(asker);
    (void)told(other);
    commands_take();
    seen_count = 0;
}

static mu_result order(const char *text)
{
    return hands_do(&hands, text, asker->id, NUMBER);
}

/* --- what is no order ------------------------------------------------------------------------- */

static void bad(const char *text, const char *said)
{
    CU_ASSERT_EQUAL(order(text), MU_FAULT_USAGE);
    READS(hands.said, said);
}

static void test_what_is_no_order(void)
{
    static char line[HANDS_LINE_MAX + 2], text[HANDS_TEXT_MAX + 2], when[MU_CONDITION_MAX + 16];
    begin();
    bad("", "expected place, push, reset, sensor, pace or save\n");
    bad("\nat 3", "expected place, push, reset, sensor, pace or save\n");
    bad("save /tmp/state", "expected place, push, reset, sensor or pace\n");
    bad("place a b c d e f g h i", "expected place, push, reset, sensor or pace\n");
    bad("place red 1\n2", "expected place NAME X Y [DEG]\n");
    bad("reset\nat ", "at: expected seconds of the run, from 0 on\n");
    bad("reset\nat -0.1", "at: expected seconds of the run, from 0 on\n");
    bad("reset\nat nan", "at: expected seconds of the run, from 0 on\n");
    bad("reset\nat 2e9", "at: expected seconds of the run, from 0 on\n");
    bad("reset\nat 3 s", "at: expected seconds of the run, from 0 on\n");
    bad("reset\nthen reset", "expected at SECONDS or when CONDITION in a line\n");
    memset(line, 'x', sizeof line - 1);
    bad(line, "no order is that long\n");
    memset(text, '\n', sizeof text - 1);
    memcpy(text, "reset", 5);
    bad(text, "no order is that long\n");
    memset(when, 'x', sizeof when - 1);
    memcpy(when, "reset\nwhen ", 11);
    bad(when, "when: no condition is that long\n");
    bus_wait(&bus, 1, 50000000);
    commands_take();
    CU_ASSERT_EQUAL(seen_count, 0);
}

static void test_without_a_run_nothing_goes_out(void)
{
    begin();
    simulator_is("simulator.1", muster_RUN_DONE);
    CU_ASSERT_EQUAL(order("reset"), MU_ABSENT);
    READS(hands.said, "no run lives\n");
    simulator_is("", muster_RUN_RUNNING); /* its scene has not come */
    CU_ASSERT_EQUAL(order("reset"), MU_ABSENT);
    hands_round(&hands, mu_clock_ns() + 3600 * SECOND_NS);
    READS(told(asker), "");
}

/* --- what goes out, and what comes back ------------------------------------------------------- */

static void test_an_order_goes_out(void)
{
    begin();
    CU_ASSERT_EQUAL(order("place  red\t1 -2.5 90"), MU_OK);
    const struct seen *first = seen_await(1);
    READS(first->simulator, "simulator.1");
    READS(first->source, "page");
    READS(first->name, "red");
    READS(first->when, "");
    CU_ASSERT(first->order == muster_RUN_PLACE && first->due_ns == 0);
    CU_ASSERT_EQUAL(order("reset red\nat 1.5\nwhen red near blue 0.5"), MU_OK);
    const struct seen *second = seen_await(2);
    CU_ASSERT(second->seq > first->seq && second->due_ns == 1500000000u);
    READS(second->when, "red near blue 0.5");
}

static void test_who_has_asked_is_told_by_his_number(void)
{
    begin();
    CU_ASSERT_EQUAL(order("reset red"), MU_OK);
    uint64_t seq = seen_await(1)->seq;
    answer("page", seq, muster_ORDER_DONE, "");
    has(round_and_hear(asker), "event: ordered\ndata: {\"ask\": 7, \"good\": true, \"step\": 42, "
                               "\"text\": \"\", \"order\": \"reset red\"");
    has(told(other), "{\"ask\": 0, \"good\": true, \"step\": 42");
    CU_ASSERT_EQUAL(order("reset nobody"), MU_OK);
    answer("page", seen_await(2)->seq, muster_ORDER_NO_NAME, "no such \"body\"");
    has(round_and_hear(asker), "\"good\": false, \"step\": 42, \"text\": \"no such \\\"body\\\"\"");
}

static void test_what_is_no_answer_to_us_ends_nothing(void)
{
    begin();
    CU_ASSERT_EQUAL(order("reset red"), MU_OK);
    uint64_t seq = seen_await(1)->seq;
    answer("operator", seq, muster_ORDER_DONE, "");
    answer("page", 0, muster_ORDER_DONE, ""); /* 0 is what a free place has */
    answer("page", seq + 1, muster_ORDER_DONE, "");
    for (int i = 0; i < 20; i++) {
        bus_wait(&bus, 1, 5000000);
        hands_round(&hands, mu_clock_ns());
    }
    READS(told(asker), "");
    answer("page", seq, muster_ORDER_DONE, "");
    answer("page", seq, muster_ORDER_REFUSED, "twice");
    has(round_and_hear(asker), "\"good\": true");
    bus_wait(&bus, 1, 20000000);
    hands_round(&hands, mu_clock_ns());
    READS(told(asker), "");
}

static void test_who_has_asked_has_left(void)
{
    begin();
    CU_ASSERT_EQUAL(order("reset red"), MU_OK);
    uint64_t seq = seen_await(1)->seq;
    viewers_release(asker);
    asker = viewers_take(&viewers); /* the same place, and nobody that has asked */
    answer("page", seq, muster_ORDER_DONE, "");
    has(round_and_hear(other), "\"ask\": 0");
    has(told(asker), "\"ask\": 0");
}

static void test_a_run_without_steps_answers_nothing(void)
{
    begin();
    CU_ASSERT_EQUAL(order("reset red"), MU_OK);
    uint64_t seq = seen_await(1)->seq, now_ns = mu_clock_ns();
    hands_round(&hands, now_ns + 9 * SECOND_NS);
    READS(told(asker), "");
    hands_round(&hands, now_ns + 11 * SECOND_NS);
    has(told(asker),
        "\"good\": false, \"step\": -1, \"text\": \"no answer: the run makes no steps\"");
    answer("page", seq, muster_ORDER_DONE, "");
    bus_wait(&bus, 1, 50000000);
    hands_round(&hands, mu_clock_ns());
    READS(told(asker), ""); /* he was told already */
}

/* --- for later -------------------------------------------------------------------------------- */

static void test_what_waits_stands_on_the_board(void)
{
    struct board_event *later = &board.items[BOARD_LATER];
    begin();
    CU_ASSERT_EQUAL(order("reset blue"), MU_OK);
    CU_ASSERT_EQUAL(order("reset red\nat 30\nwhen red \"stalled\""), MU_OK);
    uint64_t seq = seen_await(2)->seq;
    hands_round(&hands, mu_clock_ns());
    READS(later->text.at,
          "event: later\ndata: {\"orders\": [{\"order\": \"reset red\", \"at_s\": 30, "
          "\"when\": \"red \\\"stalled\\\"\"}]}\n\n");
    hands_round(&hands, mu_clock_ns() + 9 * SECOND_NS);
    hands_round(&hands, mu_clock_ns() + 3600 * SECOND_NS); /* ends the other one alone */
    CU_ASSERT_PTR_NULL(strstr(told(asker), "reset red"));
    answer("page", seq, muster_ORDER_DONE, "");
    has(round_and_hear(asker), "\"order\": \"reset red\", \"at_s\": 30");
    READS(later->text.at, "event: later\ndata: {\"orders\": []}\n\n");
}

static void test_it_ends_with_its_run(void)
{
    begin();
    CU_ASSERT_EQUAL(order("reset red\nat 1000"), MU_OK);
    (void)seen_await(1);
    uint64_t now_ns = mu_clock_ns();
    simulator_is("simulator.1", muster_RUN_DONE);
    hands_round(&hands, now_ns);
    READS(told(asker), ""); /* the answer may be on its way */
    hands_round(&hands, now_ns + SECOND_NS);
    has(told(asker), "\"good\": false, \"step\": -1, \"text\": \"the run has ended\"");
}

static void test_the_next_run_does_not_have_it(void)
{
    begin();
    CU_ASSERT_EQUAL(order("reset red\nwhen red stalled"), MU_OK);
    (void)seen_await(1);
    uint64_t now_ns = mu_clock_ns();
    simulator_is("simulator.2", muster_RUN_RUNNING);
    hands_round(&hands, now_ns);
    hands_round(&hands, now_ns + SECOND_NS);
    has(told(asker), "\"text\": \"the run has ended\"");
}

static void test_an_answer_behind_the_end_counts(void)
{
    begin();
    CU_ASSERT_EQUAL(order("reset red\nat 3"), MU_OK);
    uint64_t seq = seen_await(1)->seq;
    simulator_is("simulator.1", muster_RUN_DONE);
    hands_round(&hands, mu_clock_ns());
    answer("page", seq, muster_ORDER_DONE, "");
    has(round_and_hear(asker), "\"good\": true");
}

static void test_limit_orders_that_wait(void)
{
    begin();
    for (int i = 0; i < HANDS_LATER_MAX; i++) {
        CU_ASSERT_EQUAL(order("reset red\nat 1000"), MU_OK);
    }
    CU_ASSERT_EQUAL(order("reset red\nat 1000"), MU_FULL);
    READS(hands.said, "too many orders wait for their answers\n");
    uint64_t seq = seen_await(HANDS_LATER_MAX)->seq;
    for (int i = HANDS_LATER_MAX; i < HANDS_ASKS_MAX; i++) { /* there is room for those at once */
        CU_ASSERT_EQUAL(order("reset red"), MU_OK);
        (void)seen_await((size_t)i + 1);
    }
    CU_ASSERT_EQUAL(order("reset red"), MU_FULL);
    answer("page", seq, muster_ORDER_DONE, "");
    has(round_and_hear(asker), "\"good\": true");
    CU_ASSERT_EQUAL(order("reset red\nat 1000"), MU_OK);
}

static int open_all(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    board_init(&board);
    viewers_init(&viewers, 1);
    asker = viewers_take(&viewers);
    other = viewers_take(&viewers);
    watch.board = &board;
    struct bus_options options = {
        .domain = 100 + (int)(getpid() % 50), .place = BUS_AGENT, .name = "test"};
    bool open = bus_open(&bus, &options) == MU_OK &&
                hands_open(&hands, &bus, &viewers, &watch) == MU_OK &&
                bus_reader_open(&bus, BUS_RUN_COMMAND, NULL, &commands) == MU_OK &&
                bus_writer_open(&bus, BUS_RUN_ANSWER, NULL, NULL, &answers) == MU_OK;
    return open ? 0 : -1;
}

static int close_all(void)
{
    bus_close(&bus);
    return 0;
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"what is no order", test_what_is_no_order},
        {"without a run nothing goes out", test_without_a_run_nothing_goes_out},
        {"an order goes out", test_an_order_goes_out},
        {"who has asked is told by his number", test_who_has_asked_is_told_by_his_number},
        {"what is no answer to us ends nothing", test_what_is_no_answer_to_us_ends_nothing},
        {"who has asked has left", test_who_has_asked_has_left},
        {"a run without steps answers nothing", test_a_run_without_steps_answers_nothing},
        {"what waits stands on the board", test_what_waits_stands_on_the_board},
        {"it ends with its run", test_it_ends_with_its_run},
        {"the next run does not have it", test_the_next_run_does_not_have_it},
        {"an answer behind the end counts", test_an_answer_behind_the_end_counts},
        {"limit: orders that wait", test_limit_orders_that_wait},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"web/hands", open_all, close_all, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
