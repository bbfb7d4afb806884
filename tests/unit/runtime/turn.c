/* SPDX-License-Identifier: Apache-2.0 */
/* A process that turns from one life of its broker to the next, or from one lock step, with the
 * samples of both unread: this test is the others, in the participant of the process. */
#include "core/clock.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 10000000000u;

/* One that is silent says so often that it is there. */
static const uint64_t SILENT_PAUSE_NS = 300000000;

static mu_process *process;
static mu_agent *red;
static struct bus_writer beacons, deliveries, senses;
static int64_t lived; /* the last step */
static int64_t taken; /* the last short mail */

static void shine(uint64_t incarnation)
{
    muster_Beacon b = {.broker = words("alpha"),
                       .incarnation = incarnation,
                       .host = words("elsewhere"),
                       .takes_agents = true};
    CU_ASSERT_EQUAL_FATAL(bus_write(&beacons, &b), MU_OK);
}

static void deliver_at(int64_t step, uint64_t incarnation, muster_Verdict *v, muster_Parcel *item)
{
    muster_Delivery d = {.process = words(process->name),
                         .broker = words("alpha"),
                         .broker_incarnation = incarnation,
                         .step = step};
    d.verdicts._buffer = v;
    d.verdicts._length = d.verdicts._maximum = v != NULL;
    d.parcels._buffer = item;
    d.parcels._length = d.parcels._maximum = item != NULL;
    CU_ASSERT_EQUAL_FATAL(bus_write(&deliveries, &d), MU_OK);
}

static void deliver(uint64_t incarnation, muster_Verdict *v, muster_Parcel *item)
{
    deliver_at(muster_STEP_NOW, incarnation, v, item);
}

static void deliver_in_step(int64_t step, uint64_t number)
{
    muster_Parcel item = {
        .box = words("red"), .number = number, .letter = letter("blue", number, "red", "short")};
    deliver_at(step, 5, NULL, &item);
}

static void sense_as(int64_t step, bool last)
{
    muster_Percept percept = {.robot = words("red")};
    muster_Sense s = {
        .process = words(process->name), .step = step, .lockstep = true, .last = last};
    s.robots._buffer = &percept;
    s.robots._length = s.robots._maximum = 1;
    CU_ASSERT_EQUAL_FATAL(bus_write(&senses, &s), MU_OK);
}

static void sense(int64_t step)
{
    sense_as(step, false);
}

static void answer(uint64_t incarnation)
{
    muster_Verdict v = {.agent = words("red"),
                        .accepted = true,
                        .broker_incarnation = incarnation,
                        .reason = words("")};
    deliver(incarnation, &v, NULL);
}

/* While it runs the broker dies and comes back. */
static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    if (strcmp(mail->content, "short") == 0) {
        taken = (int64_t)mail->number;
        return;
    }
    shine(5);
    answer(10);
    usleep(20000);
}

static void on_step(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    (void)a;
    lived = percept->step;
}

static void spin(int rounds)
{
    for (int i = 0; i < rounds; i++) {
        CU_ASSERT_EQUAL(mu_process_spin(process, 10000000), MU_OK);
    }
}

static bool spin_until_it_follows(uint64_t incarnation)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (process->link.incarnation != incarnation && mu_clock_ns() < until_ns) {
        CU_ASSERT_EQUAL(mu_process_spin(process, 10000000), MU_OK);
    }
    return process->link.incarnation == incarnation;
}

static void begin(void)
{
    lived = -1;
    taken = 0;
    struct mu_process_options options = {
        .domain = 100 + (int)(getpid() % 100), .name = "turning", .with_body = true, .agents = 1};
    CU_ASSERT_EQUAL_FATAL(mu_process_open(&process, &options), MU_OK);
    struct mu_handlers handlers = {.on_mail = on_mail, .on_step = on_step};
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(process, &red, "red", MU_KIND_AGENT, 0, &handlers), MU_OK);
    struct bus *bus = &process->bus;
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_BEACON, NULL, NULL, &beacons), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_DELIVERY, process->name, NULL, &deliveries),
                          MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_SENSE, process->name, NULL, &senses), MU_OK);
    shine(5);
    CU_ASSERT_TRUE_FATAL(spin_until_it_follows(5));
    answer(5);
    while (red->name_state != NAME_ACCEPTED) {
        CU_ASSERT_EQUAL_FATAL(mu_process_spin(process, 10000000), MU_OK);
    }
}

/* The last heartbeat of the earlier life is read behind the answer of the next one, which it gives
 * once: the process asks again, or mail would wait for ever. */
static void test_a_late_heartbeat_of_the_earlier_life(void)
{
    begin();
    uint64_t asked = process->incarnation;
    muster_Parcel item = {
        .box = words("red"), .number = 1, .letter = letter("blue", 1, "red", "long")};
    deliver(5, NULL, &item);
    spin(20);
    shine(10);
    CU_ASSERT_TRUE(spin_until_it_follows(10));
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (red->name_state != NAME_ACCEPTED && process->incarnation == asked &&
           mu_clock_ns() < until_ns) {
        CU_ASSERT_EQUAL(mu_process_spin(process, 10000000), MU_OK);
    }
    CU_ASSERT_TRUE(red->name_state == NAME_ACCEPTED || process->incarnation > asked);
    mu_process_close(process);
}

static bool spin_until_it_is(const int64_t *what, int64_t wanted)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (*what != wanted && mu_clock_ns() < until_ns) {
        spin(1);
    }
    return *what == wanted;
}

static bool spin_until_it_lived(int64_t step)
{
    return spin_until_it_is(&lived, step);
}

static bool spin_until_it_took(int64_t number)
{
    return spin_until_it_is(&taken, number);
}

/* Simulator and broker died before the mail of the last step was out, and what comes next is of
 * another lock step: its mail first, or its step. */
static void test_a_step_whose_mail_never_comes(void)
{
    begin();
    sense(30);
    spin(3);
    deliver_in_step(3, 1);
    spin(3);
    CU_ASSERT_EQUAL(lived, -1);
    sense(4);
    CU_ASSERT_TRUE(spin_until_it_lived(4));
    CU_ASSERT_EQUAL(taken, 1);
    sense(30);
    spin(3);
    sense(5);
    deliver_in_step(4, 2);
    CU_ASSERT_TRUE(spin_until_it_lived(5));
    CU_ASSERT_EQUAL(taken, 2);
    mu_process_close(process);
}

/* A Sense that breaks a rule of the wire: no sonar has so many ranges. */
static void nonsense(void)
{
    static float ranges_m[MU_SONARS_MAX + 1];
    muster_Percept percept = {.robot = words("red")};
    percept.sonar_m._buffer = ranges_m;
    percept.sonar_m._length = percept.sonar_m._maximum = MU_SONARS_MAX + 1;
    muster_Sense s = {.process = words(process->name), .step = 31, .lockstep = true};
    s.robots._buffer = &percept;
    s.robots._length = s.robots._maximum = 1;
    CU_ASSERT_EQUAL_FATAL(bus_write(&senses, &s), MU_OK);
}

/* Its mail comes late, behind that of an earlier lock step; meanwhile its reader is looked into. */
static void test_a_step_that_waits_stays_as_it_is(void)
{
    begin();
    sense(30);
    deliver_in_step(3, 1);
    spin(10);
    nonsense();
    spin(10);
    deliver_in_step(29, 2);
    CU_ASSERT_TRUE(spin_until_it_lived(30));
    sense(40);
    deliver_in_step(30, 3);
    spin(10);
    process->sense.batches = UINT32_MAX; /* its memory is emptied at the next look */
    spin(10);
    deliver_in_step(39, 4);
    CU_ASSERT_TRUE(spin_until_it_lived(40));
    mu_process_close(process);
}

/* Nobody takes the mail of the last step: it is in hand when the next lock step begins, with more
 * behind it than there is room for. */
static void test_the_last_mail_of_an_earlier_lock_step(void)
{
    begin();
    sense(30);
    deliver_in_step(29, 1);
    CU_ASSERT_TRUE(spin_until_it_lived(30));
    deliver_in_step(30, 2);
    for (int i = 0; i < 2 * INBOX_EACH; i++) {
        deliver(5, NULL, NULL);
    }
    spin(3);
    sense(1);
    deliver_in_step(0, 3);
    CU_ASSERT_TRUE(spin_until_it_lived(1));
    mu_process_close(process);
}

static bool has_seen(const void *self, int64_t step)
{
    return *(const int64_t *)self >= step;
}

/* Such as the Frame of the step before. */
static void test_a_step_waits_for_what_is_to_be_seen(void)
{
    int64_t last = 28;
    begin();
    process_see_first(process, has_seen, &last);
    sense(30);
    deliver_in_step(29, 1);
    spin(50);
    CU_ASSERT_EQUAL(taken, 0);
    last = 29;
    process_turn(process);
    CU_ASSERT_EQUAL(taken, 1);
    CU_ASSERT_TRUE(spin_until_it_lived(30));
    mu_process_close(process);
}

/* Who serves several runs hears mail between two of them, too. */
static void test_between_two_lock_steps(void)
{
    begin();
    sense(30);
    deliver_in_step(29, 1);
    CU_ASSERT_TRUE(spin_until_it_lived(30));
    deliver_in_step(30, 2);
    process->role = PROCESS_WATCH; /* or it would end with the run */
    sense_as(31, true);
    while (process_in_lockstep(process)) {
        spin(1);
    }
    process->role = PROCESS_BODY;
    CU_ASSERT_TRUE(spin_until_it_took(2));
    deliver_in_step(muster_STEP_NOW, 3);
    CU_ASSERT_TRUE(spin_until_it_took(3));
    deliver_in_step(-1, 4);
    spin(50);
    CU_ASSERT_EQUAL(taken, 3);
    sense(0);
    CU_ASSERT_TRUE(spin_until_it_lived(0));
    CU_ASSERT_EQUAL(taken, 4);
    mu_process_close(process);
}

/* In lock step another process answers for who has moved: what it says after that does not go out,
 * and its place is not kept for it. */
static void test_who_moved_in_lock_step_keeps_no_place(void)
{
    mu_agent *blue;
    struct mu_mail bye = {.dst = "blue", .content = "bye"};
    begin();
    sense(30);
    deliver_in_step(29, 1);
    CU_ASSERT_TRUE(spin_until_it_lived(30));
    mu_agent_leave(red);
    CU_ASSERT_EQUAL(mu_agent_send(red, &bye, NULL), MU_OK);
    sense(31);
    deliver_in_step(30, 2);
    CU_ASSERT_TRUE(spin_until_it_lived(31));
    spin(3);
    CU_ASSERT_EQUAL(mu_agent_join(process, &blue, "blue", MU_KIND_ROBOT, 0, NULL), MU_OK);
    mu_process_close(process);
}

/* @return how often red was said to be there since the last look */
static unsigned said_to_be_there(struct bus_reader *registrations)
{
    unsigned count = 0;
    enum bus_life life;
    const muster_Registration *r;
    while ((r = bus_next(registrations, &life))) {
        count += life == BUS_DATA && r->agents._length > 0 &&
                 r->agents._buffer[0].state != muster_STATE_ABSENT;
    }
    return count;
}

static void say(const char *content)
{
    struct mu_mail word = {.dst = "blue", .content = content};
    CU_ASSERT_EQUAL(mu_agent_send(red, &word, NULL), MU_OK);
}

static void begin_and_listen(struct bus_reader *registrations)
{
    begin();
    CU_ASSERT_EQUAL_FATAL(
        bus_reader_open_deep(&process->bus, BUS_REGISTRATION, NULL, 64, registrations), MU_OK);
}

/* Its last words were for a broker that has died: the next one, which hears none of them, does not
 * hear of it either. */
static void test_who_has_left_is_nothing_to_the_next_broker(void)
{
    struct bus_reader registrations;
    begin_and_listen(&registrations);
    say("bye");
    mu_agent_set_state(red, MU_GONE);
    spin(3);
    (void)said_to_be_there(&registrations);
    shine(10);
    CU_ASSERT_TRUE(spin_until_it_follows(10));
    spin(3);
    CU_ASSERT_EQUAL(said_to_be_there(&registrations), 0);
    mu_process_close(process);
}

static unsigned samples_take(struct bus_reader *reader)
{
    unsigned count = 0;
    enum bus_life life;
    while (bus_next(reader, &life)) {
        count++;
    }
    return count;
}

/* Its broker has other signs of its life. */
static void test_one_that_speaks_says_less_often_that_it_is_there(void)
{
    struct bus_reader registrations, ups;
    begin_and_listen(&registrations);
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&process->bus, BUS_UP, process->link.partition, &ups),
                          MU_OK);
    uint64_t began_ns = mu_clock_ns();
    unsigned heard = 0;
    while (heard == 0 && mu_clock_ns() - began_ns < PATIENCE_NS) {
        say("here");
        spin(1);
        heard += samples_take(&ups);
    }
    (void)said_to_be_there(&registrations);
    began_ns = mu_clock_ns();
    unsigned said = 0;
    for (uint64_t mails = 0; mails < 12; spin(1)) {
        if (mu_clock_ns() - began_ns >= mails * SILENT_PAUSE_NS / 6) {
            say("here");
            mails++;
        }
        said += said_to_be_there(&registrations);
        heard += samples_take(&ups);
    }
    CU_ASSERT_TRUE(heard > 1);
    CU_ASSERT_EQUAL(said, 0);
    began_ns = mu_clock_ns(); /* it is silent */
    while (said == 0 && mu_clock_ns() - began_ns < PATIENCE_NS) {
        spin(1);
        (void)samples_take(&ups);
        said = said_to_be_there(&registrations);
    }
    CU_ASSERT_EQUAL(said, 1);
    mu_process_close(process);
}

int main(void)
{
    unsetenv("CYCLONEDDS_URI");
    CU_TestInfo tests[] = {
        {"a late heartbeat", test_a_late_heartbeat_of_the_earlier_life},
        {"a step without mail", test_a_step_whose_mail_never_comes},
        {"a step that waits", test_a_step_that_waits_stays_as_it_is},
        {"the last mail", test_the_last_mail_of_an_earlier_lock_step},
        {"a step waits for what is to be seen", test_a_step_waits_for_what_is_to_be_seen},
        {"between two lock steps", test_between_two_lock_steps},
        {"one that speaks", test_one_that_speaks_says_less_often_that_it_is_there},
        {"the next broker", test_who_has_left_is_nothing_to_the_next_broker},
        {"who moved", test_who_moved_in_lock_step_keeps_no_place},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/turn", tests);
}
