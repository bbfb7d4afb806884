/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Who waits lends its turn to the thread that brings a sample.  Here that is a second thread of the
 * test, which writes: DDS hands a sample to the readers of its own process where it was written.
 */
#include "bus/bus.h"
#include "samples.h"
#include "suite.h"
#include "wire.h"

#include <CUnit/Basic.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const int64_t LONG_NS = 20000000000;

static struct bus bus; /* static: DDS keeps pointers into it */
static struct bus_reader reader, other;
static struct bus_writer writer, to_other;

/* What the turns did, and what they are to do. */
static struct {
    atomic_int turns, taken, inside;
    atomic_bool two_at_a_time, lender_had_it;
    pthread_t lender;
    bool takes, done;
    int enough; /* taken: then all is done no more; 0: never */
    useconds_t works_us;
} seen;

static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    struct bus_options options = {
        .domain = 100 + (int)(getpid() % 100), .place = BUS_AGENT, .name = "test"};
    return bus_open(&bus, &options) != MU_OK ||
           bus_reader_open(&bus, BUS_DELIVERY, "p1", &reader) != MU_OK ||
           bus_reader_open(&bus, BUS_DELIVERY, "p2", &other) != MU_OK ||
           bus_writer_open(&bus, BUS_DELIVERY, "p1", NULL, &writer) != MU_OK ||
           bus_writer_open(&bus, BUS_DELIVERY, "p2", NULL, &to_other) != MU_OK;
}

static int end(void)
{
    bus_close(&bus);
    return 0;
}

static mu_result write_one(const struct bus_writer *to)
{
    muster_Delivery d = {.process = words("p"), .step = 1};
    return bus_write(to, &d);
}

static int take_all(struct bus_reader *from)
{
    int count = 0;
    for (enum bus_life life; bus_next(from, &life) != NULL;) {
        count++;
    }
    return count;
}

static bool turn(void *self)
{
    CU_ASSERT_PTR_EQUAL(self, &seen);
    seen.two_at_a_time = seen.two_at_a_time || atomic_fetch_add(&seen.inside, 1) > 0;
    seen.lender_had_it = seen.lender_had_it || pthread_equal(pthread_self(), seen.lender);
    usleep(seen.works_us);
    seen.taken += seen.takes ? take_all(&reader) : 0;
    seen.turns++;
    atomic_fetch_sub(&seen.inside, 1);
    return seen.done && (seen.enough == 0 || seen.taken < seen.enough);
}

/* Forgets, and says what turns are to do: to take what lies in the reader, to say that all is done.
 */
static void expect(bool takes, bool done, useconds_t works_us)
{
    (void)take_all(&reader);
    (void)take_all(&other);
    memset(&seen, 0, sizeof seen);
    seen.lender = pthread_self();
    seen.takes = takes;
    seen.done = done;
    seen.works_us = works_us;
}

static void check_one_at_a_time(void)
{
    CU_ASSERT_FALSE(seen.two_at_a_time);
    CU_ASSERT_FALSE(seen.lender_had_it);
    CU_ASSERT_EQUAL(seen.inside, 0); /* who has begun is done when the lender goes on */
}

/* --- who writes ------------------------------------------------------------------------------- */

static struct {
    pthread_t thread;
    const struct bus_writer *to;
    int samples, written;
    bool to_a_lender;
} errand;

static bool is_lent(void)
{
    pthread_mutex_lock(&bus.lock);
    bool lent = bus.turn && !bus.called;
    pthread_mutex_unlock(&bus.lock);
    return lent;
}

static void *errand_run(void *unused)
{
    while (errand.to_a_lender && !is_lent()) {
        usleep(200);
    }
    for (int i = 0; i < errand.samples; i++) {
        errand.written += write_one(errand.to) == MU_OK;
        usleep(2000);
    }
    return unused;
}

/* Somebody writes so many samples, to_a_lender: the first one when the turn is lent. */
static void errand_begin(const struct bus_writer *to, int samples, bool to_a_lender)
{
    errand.to = to;
    errand.samples = samples;
    errand.written = 0;
    errand.to_a_lender = to_a_lender;
    CU_ASSERT_EQUAL_FATAL(pthread_create(&errand.thread, NULL, errand_run, NULL), 0);
}

static void errand_end(void)
{
    CU_ASSERT_EQUAL(pthread_join(errand.thread, NULL), 0);
    CU_ASSERT_EQUAL(errand.written, errand.samples);
}

/* --- tests ------------------------------------------------------------------------------------ */

static void test_handled_where_it_came(void)
{
    expect(true, true, 0);
    seen.enough = 5;
    errand_begin(&writer, 5, true);
    bus_wait_lending(&bus, LONG_NS, turn, &seen);
    errand_end();
    check_one_at_a_time();
    CU_ASSERT(seen.turns > 0);
    CU_ASSERT_EQUAL(seen.taken, 5);
}

static void test_a_turn_that_is_not_done_calls(void)
{
    expect(true, false, 0);
    errand_begin(&writer, 1, true);
    bus_wait_lending(&bus, LONG_NS, turn, &seen); /* or the alarm ends this test */
    errand_end();
    check_one_at_a_time();
    CU_ASSERT_EQUAL(seen.turns, 1);
    CU_ASSERT_EQUAL(seen.taken, 1);
}

static void test_what_a_turn_leaves_calls(void)
{
    expect(true, true, 0);
    errand_begin(&to_other, 1, true);
    bus_wait_lending(&bus, LONG_NS, turn, &seen);
    errand_end();
    CU_ASSERT_EQUAL(seen.turns, 1);
    CU_ASSERT_EQUAL(seen.taken, 0);
    CU_ASSERT_EQUAL(take_all(&other), 1);

    expect(false, true, 0); /* nor does it go round for ever */
    errand_begin(&writer, 1, true);
    bus_wait_lending(&bus, LONG_NS, turn, &seen);
    errand_end();
    CU_ASSERT_EQUAL(seen.turns, 1);
    CU_ASSERT_EQUAL(take_all(&reader), 1);
}

static void test_what_lies_there_is_the_lender_s(void)
{
    expect(true, true, 0);
    CU_ASSERT_EQUAL(write_one(&writer), MU_OK);
    bus_wait_lending(&bus, LONG_NS, turn, &seen);
    CU_ASSERT_EQUAL(seen.turns, 0);
    CU_ASSERT_EQUAL(take_all(&reader), 1);
}

/* Whoever has the turn when the time is over is done before the lender goes on. */
static void test_a_turn_that_has_begun_is_awaited(void)
{
    int turns = 0, inside = 0;
    for (int i = 0; i < 10; i++) {
        expect(true, true, 5000);
        errand_begin(&writer, 3, false);
        for (int mine = 0; seen.taken + mine < 3; mine += take_all(&reader)) {
            bus_wait_lending(&bus, 1000000 + i * 500000, turn, &seen);
            inside += seen.inside;
        }
        errand_end();
        check_one_at_a_time();
        turns += seen.turns;
    }
    CU_ASSERT_EQUAL(inside, 0);
    CU_ASSERT(turns > 0);
}

/* Nobody has lent anything: what comes waits. */
static void test_nothing_is_lent_between_waits(void)
{
    expect(true, true, 0);
    bus_wait_lending(&bus, 1000000, turn, &seen);
    errand_begin(&writer, 3, false);
    errand_end();
    CU_ASSERT_EQUAL(seen.turns, 0);
    bus_wait(&bus, 3, LONG_NS);
    CU_ASSERT_EQUAL(take_all(&reader), 3);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"handled where it came", test_handled_where_it_came},
        {"a turn that is not done calls", test_a_turn_that_is_not_done_calls},
        {"what a turn leaves calls", test_what_a_turn_leaves_calls},
        {"what lies there is the lender's", test_what_lies_there_is_the_lender_s},
        {"a turn that has begun is awaited", test_a_turn_that_has_begun_is_awaited},
        {"nothing is lent between waits", test_nothing_is_lent_between_waits},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"bus/lending", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
