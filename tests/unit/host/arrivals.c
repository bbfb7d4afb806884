/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Who comes to a host, without a network: the process is put together in memory, and nobody gives
 * names away, so that each who is taken in waits for its name.
 */
#include "core/log.h"
#include "host/host.h"
#include "mind/engine/engine.h"
#include "mind/mind.h"
#include "runtime/process.h"
#include "runtime/transfers.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PLACES = 3, REFUSALS = 100 };

static mu_process process;
static struct robot_options robots_set;
static struct host_options host_set = {.robots = &robots_set};
static struct host *host;
static char bytes[MIGRATION_SNAPSHOT_MAX], why[MU_FAULT_TEXT_MAX + 1];
static struct mu_text text;

static void host_begin_for(uint32_t places)
{
    memset(&process, 0, sizeof process);
    process.role = PROCESS_BODY;
    process_take_memory(&process, places + 1, 0);
    host_set = (struct host_options){
        .robots = &robots_set, .agents = places, .bytes = MIGRATION_SNAPSHOT_MAX - 1};
    robots_set.name = "north";
    host = host_make(&host_set);
    host->group.process = &process;
    (void)mu_text_copy(host->folder, sizeof host->folder, "rules");
    CU_ASSERT_EQUAL_FATAL(host_join(host), MU_OK);
}

static void host_begin(void)
{
    host_begin_for(PLACES);
}

/* A passport; what stands behind it is added by whoever wants it. */
static void header_write(enum migration_purpose purpose, const char *name, uint64_t epoch)
{
    struct snapshot_header p = {.purpose = purpose,
                                .state = MU_RUNNING,
                                .passage = {.epoch = epoch, .kind = MU_KIND_ROBOT}};
    (void)mu_text_copy(p.name, sizeof p.name, name);
    mu_text_init(&text, bytes, sizeof bytes);
    snapshot_header_add(&text, &p);
}

static mu_result nothing_sent(void *self, const struct mind_letter *letter)
{
    (void)self;
    (void)letter;
    return MU_OK;
}

static void nothing_printed(void *self, const char *words)
{
    (void)self;
    (void)words;
}

static void mover_write(const char *name, uint64_t epoch)
{
    static struct mind *mind;
    struct mu_fault fault;
    struct mu_text snapshot;
    struct mind_options options = {.name = name,
                                   .ports = {.send = nothing_sent, .print = nothing_printed}};
    mind = mind ? mind : mind_reserve();
    mind_close(mind);
    header_write(MIGRATION_MOVE, name, epoch);
    mu_text_init(&snapshot, text.at + text.len, text.size - text.len);
    CU_ASSERT_EQUAL_FATAL(mind_begin(mind, &options, &fault), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mind_save(mind, &snapshot, &fault), MU_OK);
    text.len += snapshot.len;
}

static void launch_write(const char *name, const char *rules)
{
    header_write(MIGRATION_LAUNCH, name, 0);
    mu_text_add(&text, rules);
}

/* @return who was taken in, or NULL: why says why not */
static struct robot *take(void)
{
    struct arrival a = {.directive = true, .text = text};
    why[0] = '\0';
    return host_take_in(host, &a, why);
}

static uint32_t places_used(void)
{
    uint32_t used = 0;
    for (uint32_t i = 0; i < host->group.count; i++) {
        used += host->group.robots[i].state != ROBOT_VACANT;
    }
    return used;
}

/* Bytes that the minds of a host have. */
static size_t minds_held(void)
{
    size_t held = 0;
    for (uint32_t i = 0; i < host->group.count; i++) {
        held += host->group.robots[i].mind->heap.held;
    }
    return held;
}

static void test_a_later_copy_takes_the_place_of_one_that_waits(void)
{
    host_begin();
    mover_write("red", 1);
    struct robot *older = take();
    CU_ASSERT_PTR_NOT_NULL_FATAL(older);
    CU_ASSERT_TRUE(robot_state_arrives(older->state));
    mu_agent *agent = older->agent;
    mover_write("red", 2);
    struct robot *later = take();
    CU_ASSERT_PTR_NOT_NULL_FATAL(later);
    CU_ASSERT_TRUE(robot_state_arrives(later->state));
    CU_ASSERT_EQUAL(mu_agent_passage(later->agent).epoch, 2);
    CU_ASSERT_EQUAL(mu_agent_state(agent), MU_GONE);
    CU_ASSERT_EQUAL(places_used(), 1);
    for (uint64_t epoch = 1; epoch <= 2; epoch++) {
        mover_write("red", epoch);
        CU_ASSERT_PTR_NULL(take());
        READS(why, "name-taken");
    }
    CU_ASSERT_TRUE(robot_state_arrives(later->state));
    CU_ASSERT_EQUAL(places_used(), 1);
}

static void test_one_that_lives_here_stays(void)
{
    host_begin();
    mover_write("red", 1);
    struct robot *r = take();
    CU_ASSERT_PTR_NOT_NULL_FATAL(r);
    lifecycle_on_registered(r, r->agent, true, "");
    CU_ASSERT_FALSE(robot_state_arrives(r->state));
    mover_write("red", 2);
    CU_ASSERT_PTR_NULL(take());
    CU_ASSERT_EQUAL(mu_agent_state(r->agent), MU_RUNNING);
    CU_ASSERT_EQUAL(places_used(), 1);
}

static void refused_write(int number)
{
    switch (number % 4) {
    case 0: launch_write("ruby", "(defrule broken (a) => (nonsense))"); return;
    case 1: launch_write("ruby", "group a b\n(deffacts f (x))"); return;
    case 2: mover_write("red", 0); return; /* who is here already, and is no older one */
    default: break;
    }
    mover_write("ruby", 1);
    text.at[--text.len] = '\0'; /* is not whole */
}

static void test_who_is_refused_leaves_nothing_behind(void)
{
    host_begin();
    mover_write("red", 1);
    CU_ASSERT_PTR_NOT_NULL_FATAL(take());
    size_t held = minds_held();
    CU_ASSERT(held > 0);
    for (int i = 0; i < REFUSALS; i++) {
        refused_write(i);
        CU_ASSERT_PTR_NULL(take());
        CU_ASSERT_NOT_EQUAL(why[0], '\0');
        CU_ASSERT_EQUAL(minds_held(), held);
        CU_ASSERT_EQUAL(places_used(), 1);
    }
    for (int i = 1; i < PLACES; i++) {
        mover_write(i == 1 ? "ruby" : "rosa", 1);
        CU_ASSERT_PTR_NOT_NULL(take());
    }
    mover_write("opal", 1);
    CU_ASSERT_PTR_NULL(take());
    READS(why, "full");
}

/* A step may come before the broker's word: it is passed over, and counted. */
static void test_a_step_before_the_name_is_passed_over(void)
{
    struct mu_percept step = {.robot = "ruby", .step = 7, .time_ns = 700000000};
    host_begin();
    mover_write("ruby", 1);
    struct robot *r = take();
    CU_ASSERT_PTR_NOT_NULL_FATAL(r);
    step_on_step(r, r->agent, &step);
    CU_ASSERT_EQUAL(r->state, ROBOT_ARRIVES);
    CU_ASSERT_EQUAL(r->early_steps, 1);
    lifecycle_on_registered(r, r->agent, true, "");
    CU_ASSERT_EQUAL(r->state, ROBOT_RESTS);
    step_on_step(r, r->agent, &step);
    CU_ASSERT_EQUAL(r->state, ROBOT_PERCEIVES); /* it runs: its mind takes it when it acts */
    CU_ASSERT_EQUAL(r->early_steps, 1);
    mu_agent_suspend(r->agent, "");
    CU_ASSERT_EQUAL(r->state, ROBOT_RESTS);
    step_on_step(r, r->agent, &step);
    CU_ASSERT_EQUAL(r->state, ROBOT_RESTS);
    group_process_drop(r);
    CU_ASSERT_EQUAL(r->state, ROBOT_VACANT);
    step_on_step(r, r->agent, &step);
    CU_ASSERT_EQUAL(r->state, ROBOT_VACANT);
}

/* --- journeys --------------------------------------------------------------------------------- */

/* Who lives on a host, and knows of another one. */
static void team_begin(uint32_t count)
{
    host_begin_for(count);
    muster_Member south = {.name = words("south"),
                           .kind = muster_KIND_HOST,
                           .state = muster_STATE_RUNNING,
                           .broker = words("main"),
                           .host = words("h")};
    muster_Delivery d = {.process = words("p1"), .step = muster_STEP_NOW};
    d.members._buffer = &south;
    d.members._length = 1;
    step_take_delivery(&process, &d, NULL);
    for (uint32_t i = 0; i < count; i++) {
        char name[16];
        snprintf(name, sizeof name, "w_%u", (unsigned)i);
        mover_write(name, 1);
        struct robot *r = take();
        CU_ASSERT_PTR_NOT_NULL_FATAL(r);
        lifecycle_on_registered(r, r->agent, true, "");
    }
}

static mu_result set_out(struct robot *r)
{
    struct mind_travel south = {.kind = MIND_MOVES, .host = "south"};
    return migration_begin(r, &south, NULL);
}

static bool has_heard(struct robot *r, const char *fact)
{
    static char said[4096];
    struct mu_text out;
    mu_text_init(&out, said, sizeof said);
    mind_feel_nothing(r->mind, 0);
    return mind_facts(r->mind, "event", &out) == MU_OK && strstr(said, fact);
}

static uint32_t migrations_in(enum migration_state state)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < host->group.migrations_max; i++) {
        count += host->group.migrations[i].robot && host->group.migrations[i].state == state;
    }
    return count;
}

static void test_an_agent_makes_one_journey_at_a_time(void)
{
    team_begin(2);
    struct robot *red = &host->group.robots[0], *blue = &host->group.robots[1];
    CU_ASSERT_EQUAL(set_out(red), MU_OK);
    CU_ASSERT_EQUAL(set_out(red), MU_REFUSED);
    CU_ASSERT_EQUAL(set_out(blue), MU_OK);
    CU_ASSERT_TRUE(has_heard(red, "(event refused moveTo south busy)"));
    CU_ASSERT_FALSE(has_heard(blue, "refused"));
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_DEPARTS), 2);
    migration_step_end(&host->group);
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_DEPOSITED), 2);
    migration_step_answered(&host->group);
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_KEPT), 2);
    CU_ASSERT_TRUE(process.transfers.under_way);
}

/* What the broker says of an earlier journey is not of this one; and each hears of its own. */
static void test_words_reach_whom_they_are_about(void)
{
    team_begin(2);
    struct robot *red = &host->group.robots[0], *blue = &host->group.robots[1];
    muster_Trip word = {.word = muster_TRIP_REFUSED,
                        .agent = words("w_1"),
                        .asker = words(""),
                        .epoch = 1,
                        .reason = words("full")};
    CU_ASSERT_EQUAL(set_out(red), MU_OK);
    CU_ASSERT_EQUAL(set_out(blue), MU_OK);
    migration_step_end(&host->group);
    migration_step_answered(&host->group);
    host_hear(host, &word);
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_KEPT), 2);
    word.epoch = 2;
    host_hear(host, &word);
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_KEPT), 1);
    CU_ASSERT(agent_is_away(red) && !blue->migration);
    CU_ASSERT_EQUAL(mu_agent_state(blue->agent), MU_RUNNING);
    CU_ASSERT_EQUAL(mu_agent_state(red->agent), MU_MOVING);
    CU_ASSERT_TRUE(process.transfers.under_way);
}

/* A word that nobody waits for changes nothing, and is counted. */
static void test_words_out_of_place_are_counted(void)
{
    team_begin(1);
    muster_Trip word = {.word = muster_TRIP_READY, .agent = words("w_0"), .asker = words("")};
    struct robot *red = &host->group.robots[0];
    CU_ASSERT_EQUAL(set_out(red), MU_OK);
    migration_step_end(&host->group);
    word.epoch = red->migration->passage.epoch;
    host_hear(host, &word); /* the broker has not even kept it */
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_DEPOSITED), 1);
    migration_step_answered(&host->group);
    word.word = muster_TRIP_TAKEN;
    host_hear(host, &word); /* it has not let its name go */
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_KEPT), 1);
    CU_ASSERT_EQUAL(host->group.migrations_unexpected, 2);
    word.word = muster_TRIP_STORED;
    host_hear(host, &word);
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_SENDS), 1);
    CU_ASSERT_EQUAL(host->group.migrations_unexpected, 2);
}

static void test_limit_journeys(void)
{
    team_begin(MU_CAPSULES_MAX + 1);
    struct robot *last = &host->group.robots[MU_CAPSULES_MAX];
    for (int i = 0; i < MU_CAPSULES_MAX; i++) {
        CU_ASSERT_EQUAL(set_out(&host->group.robots[i]), MU_OK);
    }
    CU_ASSERT_EQUAL(set_out(last), MU_REFUSED);
    CU_ASSERT_TRUE(has_heard(last, "(event refused moveTo south busy)"));
    migration_step_end(&host->group);
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_DEPOSITED), MU_CAPSULES_MAX);
}

/* The second of two that do not fit goes with the next answer. */
static void test_limit_bytes_of_an_answer(void)
{
    static char much[MIGRATION_ANSWER_MAX];
    team_begin(1);
    muster_Trip word = {.word = muster_TRIP_NEW, .agent = words("ruby"), .text = much};
    memset(much, 'x', sizeof much - 1);
    CU_ASSERT_EQUAL(set_out(&host->group.robots[0]), MU_OK);
    CU_ASSERT_EQUAL(transfers_say(&process, &word), MU_OK);
    migration_step_end(&host->group);
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_LAST_WORDS), 1);
    transfers_sent(&process, 1);
    migration_step_end(&host->group);
    CU_ASSERT_EQUAL(migrations_in(MIGRATION_DEPOSITED), 1);
}

static void test_limit_words(void)
{
    host_begin();
    muster_Trip word = {.word = muster_TRIP_WANTED, .host = words("north")};
    for (int i = 0; i < TRANSFERS_OUT_MAX; i++) {
        CU_ASSERT_EQUAL(transfers_say(&process, &word), MU_OK);
    }
    CU_ASSERT_EQUAL(transfers_say(&process, &word), MU_FULL);
}

/* The first pieces of so many agents; the next sender is told to try again. */
static void test_limit_arrivals(void)
{
    host_begin();
    for (int i = 0; i <= HOST_ARRIVALS; i++) {
        char name[16];
        snprintf(name, sizeof name, "w_%d", i);
        struct mu_mail piece = {.src = name,
                                .dst = "north",
                                .conversation = name,
                                .reply_with = "1",
                                .content = "0 1000\npassport"};
        CU_ASSERT_EQUAL(host->agent->outbox.next_seq, host->agent->outbox.first_seq);
        arrival_take(host, &piece);
    }
    CU_ASSERT_EQUAL(host->agent->outbox.next_seq, host->agent->outbox.first_seq + 1);
}

/* --- files ------------------------------------------------------------------------------------ */

static char folder[] = "/tmp/muster-arrivals-XXXXXX";

static bool is_there(const char *file)
{
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    return access(path, F_OK) == 0;
}

static void folder_empty(void)
{
    char path[PATH_MAX];
    struct dirent *entry;
    DIR *d = opendir(folder);
    while (d && (entry = readdir(d))) {
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        (void)unlink(path); /* but for the folders, which stay */
    }
    if (d) {
        closedir(d);
    }
}

/* A host that writes its agents down; red began on it. */
static void host_begin_with_files(void)
{
    static const char *const natives[] = {"red=red.clp"};
    host_begin();
    robots_set.checkpoints = (struct checkpoint_options){.every_s = 60, .folder = folder};
    host_set.natives = (struct mu_option_list){.count = 1};
    host_set.natives.items[0] = natives[0];
    checkpoint_reserve(&host->group);
}

static void test_the_file_of_who_was_there_before_goes(void)
{
    folder_empty();
    host_begin_with_files();
    mover_write("ruby", 1);
    struct robot *r = take();
    CU_ASSERT_PTR_NOT_NULL_FATAL(r);
    CU_ASSERT_TRUE(is_there("ruby.capsule"));
    group_process_drop(r);
    mover_write("rosa", 1); /* in the same breath, and in the same place */
    CU_ASSERT_PTR_EQUAL(take(), r);
    CU_ASSERT_FALSE(is_there("ruby.capsule"));
    CU_ASSERT_TRUE(is_there("rosa.capsule"));
}

static void test_who_began_here_and_is_refused_does_not_begin_anew(void)
{
    folder_empty();
    host_begin_with_files();
    mover_write("red", 1);
    struct robot *r = take();
    CU_ASSERT_PTR_NOT_NULL_FATAL(r);
    CU_ASSERT_TRUE(is_there("red.capsule"));
    lifecycle_on_registered(r, r->agent, false, "held");
    checkpoint_forget(&host->group);
    CU_ASSERT_FALSE(is_there("red.capsule"));
    CU_ASSERT_TRUE(is_there("red.gone"));
}

static void test_who_comes_back_in_vain_loses_its_file(void)
{
    folder_empty();
    host_begin_with_files();
    mover_write("ruby", 1);
    CU_ASSERT_PTR_NOT_NULL(take());
    host_begin_with_files();
    CU_ASSERT_EQUAL(host_restore(host), 1);
    struct robot *r = &host->group.robots[0];
    CU_ASSERT_TRUE_FATAL(robot_state_arrives(r->state));
    lifecycle_on_registered(r, r->agent, false, "held");
    checkpoint_forget(&host->group);
    CU_ASSERT_FALSE(is_there("ruby.capsule"));
    CU_ASSERT_FALSE(is_there("ruby.gone"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a later copy takes the place of one that waits",
         test_a_later_copy_takes_the_place_of_one_that_waits},
        {"one that lives here stays", test_one_that_lives_here_stays},
        {"who is refused leaves nothing behind", test_who_is_refused_leaves_nothing_behind},
        {"a step before the name is passed over", test_a_step_before_the_name_is_passed_over},
        {"an agent makes one journey at a time", test_an_agent_makes_one_journey_at_a_time},
        {"words reach whom they are about", test_words_reach_whom_they_are_about},
        {"words out of place are counted", test_words_out_of_place_are_counted},
        {"limit: journeys", test_limit_journeys},
        {"limit: bytes of an answer", test_limit_bytes_of_an_answer},
        {"limit: words", test_limit_words},
        {"limit: arrivals", test_limit_arrivals},
        {"the file of who was there before goes", test_the_file_of_who_was_there_before_goes},
        {"who began here and is refused does not begin anew",
         test_who_began_here_and_is_refused_does_not_begin_anew},
        {"who comes back in vain loses its file", test_who_comes_back_in_vain_loses_its_file},
        CU_TEST_INFO_NULL,
    };
    mu_log_open("north", MU_LOG_ERROR);
    if (!mkdtemp(folder)) {
        return EXIT_FAILURE;
    }
    int failed = suite_run("host/arrivals", tests);
    folder_empty();
    rmdir(folder);
    return failed;
}
