/* SPDX-License-Identifier: Apache-2.0 */
/* The store itself: a file in a temporary folder, written by one broker and read by the next. */
#include "broker/control/parts.h"
#include "broker/node/disk_parts.h"
#include "broker_story.h"
#include "capture.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#define WALL 1000000000000000000ull

static char folder[] = "/tmp/muster-disk-XXXXXX";
static struct disk *disk;

static const char *file(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static uint64_t life_begin(const char *name, uint64_t wall_ns)
{
    CU_ASSERT_EQUAL_FATAL(disk_open(&disk, file(name), wall_ns), MU_OK);
    struct broker_options options = {.name = "alpha",
                                     .incarnation = disk->incarnation,
                                     .number_base = disk->number_base,
                                     .wall_ns = wall_ns,
                                     .has_store = true};
    story.b = broker_kept(&options);
    story.now_ns = 0;
    mu_text_init(&story.text, story.buffer, sizeof story.buffer);
    uint64_t refused = 99;
    CU_ASSERT_EQUAL(disk_load(disk, story.b, &refused), MU_OK);
    return refused;
}

static bool commit(void)
{
    muster_Level level;
    return journal_wanted(story.b, &level) && disk_commit(disk, story.b, level, story.now_ns);
}

static void test_everything_of_a_mail_comes_back(void)
{
    CU_ASSERT_EQUAL(life_begin("mail.db", WALL), 0);
    story_join("red");
    story_join("green");
    story_join("blue");
    story_gone("p-green");
    CU_ASSERT_TRUE(commit());
    muster_Mail sent = {.src = words("red"),
                        .seq = 7,
                        .dst = words("green,blue"),
                        .layer = 4,
                        .performative = words("ask-one"),
                        .language = words("clips"),
                        .ontology = words("rooms"),
                        .reply_with = words("q1"),
                        .in_reply_to = words("q0"),
                        .conversation = words("c"),
                        .reply_by_ns = 12345678901234,
                        .priority = -1,
                        .level = muster_LEVEL_SYNCED,
                        .hops = 3,
                        .due_ns = 0,
                        .ttl_ns = UINT64_MAX - 1,
                        .content = words("it's \"quoted\" \xc3\xa4; -- DROP")};
    muster_Roster run = {.simulator = words("sim"), .step = 1, .step_ns = MS};
    broker_roster(story.b, &run, story.now_ns);
    story_mail(sent);
    CU_ASSERT_TRUE(commit());
    EXPECT("red 7-7 stored; blue #1000000000000000001 red/7 it's \"quoted\" \xc3\xa4; -- DROP");
    disk_close(disk);

    CU_ASSERT_EQUAL(life_begin("mail.db", WALL + 1), 0);
    /* The clock has hardly moved: a broker of that name that begins now is the later one. */
    CU_ASSERT_EQUAL(disk->incarnation, WALL + 1);
    CU_ASSERT_TRUE(disk->number_base > WALL + (1ull << 39));
    const struct mail *m =
        journal_find(&story.b->journal, registry_find(&story.b->registry, "red"), 7);
    CU_ASSERT_PTR_NOT_NULL_FATAL(m);
    const muster_Mail *got = &m->letter;
    CU_ASSERT_STRING_EQUAL(got->src, sent.src);
    CU_ASSERT_STRING_EQUAL(got->dst, sent.dst);
    CU_ASSERT_STRING_EQUAL(got->performative, sent.performative);
    CU_ASSERT_STRING_EQUAL(got->language, sent.language);
    CU_ASSERT_STRING_EQUAL(got->ontology, sent.ontology);
    CU_ASSERT_STRING_EQUAL(got->reply_with, sent.reply_with);
    CU_ASSERT_STRING_EQUAL(got->in_reply_to, sent.in_reply_to);
    CU_ASSERT_STRING_EQUAL(got->conversation, sent.conversation);
    CU_ASSERT_STRING_EQUAL(got->content, sent.content);
    CU_ASSERT_EQUAL(got->layer, 4);
    CU_ASSERT_EQUAL(got->reply_by_ns, sent.reply_by_ns);
    CU_ASSERT_EQUAL(got->priority, -1);
    CU_ASSERT_EQUAL(got->level, muster_LEVEL_SYNCED);
    CU_ASSERT_EQUAL(got->hops, 3);
    CU_ASSERT_EQUAL(got->due_ns, 0);
    CU_ASSERT_EQUAL(got->ttl_ns, UINT64_MAX - 1);
    CU_ASSERT_TRUE(got->again);
    CU_ASSERT_EQUAL(m->posts.count, 2);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent ");
    disk_close(disk);
}

/* A process hands in an agent, which it has said to be on its way. */
static void capsule_deposit(const char *name, uint64_t epoch, const char *text)
{
    char process[MU_PROCESS_MAX + 1];
    struct one_up u;
    muster_Trip t = {.word = muster_TRIP_DEPOSIT,
                     .agent = words(name),
                     .asker = words(""),
                     .epoch = epoch,
                     .host = words("north"),
                     .process = words(""),
                     .reason = words(""),
                     .text = words(text)};
    snprintf(process, sizeof process, "p-%s", name);
    one_up(&u, name, process, NULL, 0, 0);
    u.up.trips = (dds_sequence_muster_Trip){._length = 1, ._buffer = &t};
    broker_up(story.b, &u.up, story.now_ns);
}

static void epoch_say(const char *name, uint64_t epoch)
{
    char process[MU_PROCESS_MAX + 1];
    snprintf(process, sizeof process, "p-%s", name);
    muster_Registration r = registration(name, process);
    entry_of(&r)->epoch = epoch;
    broker_registration(story.b, &r, story.now_ns);
}

static const struct snapshot *capsule_kept(const char *name)
{
    uint32_t agent = registry_find(&story.b->registry, name);
    for (uint32_t i = 0; i < MU_CAPSULES_MAX; i++) {
        const struct snapshot *c = &story.b->snapshots.snapshots[i];
        if (c->phase != SNAPSHOT_FREE && c->agent == agent) {
            return c;
        }
    }
    return NULL;
}

static void test_capsules_come_back(void)
{
    CU_ASSERT_EQUAL(life_begin("capsules.db", WALL), 0);
    story_join("red");
    story_join("blue");
    muster_Registration r = registration("north", "p-north");
    entry_of(&r)->kind = muster_KIND_HOST;
    broker_registration(story.b, &r, story.now_ns);
    capsule_deposit("red", 3, "it's \"red\" \xc3\xa4\n");
    capsule_deposit("blue", 1, "blue");
    CU_ASSERT_TRUE(commit());
    capsule_deposit("red", 4, "it's \"red\" \xc3\xa4\nonce more");
    epoch_say("blue", 2); /* it has stayed */
    CU_ASSERT_TRUE(commit());
    CU_ASSERT_FALSE(commit());
    disk_close(disk);

    CU_ASSERT_EQUAL(life_begin("capsules.db", WALL + 1), 0);
    const struct snapshot *c = capsule_kept("red");
    CU_ASSERT_PTR_NOT_NULL_FATAL(c);
    CU_ASSERT_EQUAL(c->epoch, 4);
    CU_ASSERT_STRING_EQUAL(story.b->snapshots.texts[c - story.b->snapshots.snapshots],
                           "it's \"red\" \xc3\xa4\nonce more");
    CU_ASSERT_PTR_NULL(capsule_kept("blue"));
    story_join("red");
    epoch_say("red", 5);
    CU_ASSERT_PTR_NULL(capsule_kept("red"));
    CU_ASSERT_TRUE(commit());
    disk_close(disk);

    CU_ASSERT_EQUAL(life_begin("capsules.db", WALL + 2), 0);
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
    disk_close(disk);
}

static void test_what_is_settled_stays_away(void)
{
    CU_ASSERT_EQUAL(life_begin("settled.db", WALL), 0);
    story_join("red");
    story_join("green");
    story_gone("p-green");
    for (uint64_t seq = 1; seq <= 50; seq++) {
        muster_Mail m = letter("red", seq, "green", "x");
        m.level = muster_LEVEL_LOGGED;
        story_mail(m);
    }
    CU_ASSERT_TRUE(commit());
    story_join("green");
    story_ack("green", WALL + 49);
    CU_ASSERT_TRUE(commit());
    disk_rest(disk, story.now_ns + 2000000000);
    disk_close(disk);
    CU_ASSERT_EQUAL(life_begin("settled.db", WALL * 2), 0);
    CU_ASSERT_EQUAL(story_status().waiting, 1);
    CU_ASSERT_EQUAL(story.b->journal.rows, 50);
    story_register("green", "p-green");
    story_match("p-green");
    EXPECT("green #2000000000000000001 red/50 x; green welcome 1048576");
    disk_close(disk);
}

static void test_a_commit_that_fails_leaves_nothing(void)
{
    CU_ASSERT_EQUAL(life_begin("fails.db", WALL), 0);
    story_join("red");
    story_join("green");
    story_gone("p-green");
    CU_ASSERT_TRUE(commit());
    (void)story_collect();
    muster_Mail m = letter("red", 1, "green", "x");
    m.level = muster_LEVEL_LOGGED;
    story_mail(m);
    CU_ASSERT_TRUE(commit());
    EXPECT("red 1-1 stored");
    /* Two more, and the first cannot be written: a row with its number is there already. */
    story.b->journal.rows = 0;
    m.seq = 2;
    story_mail(m);
    m.seq = 3;
    story_mail(m);
    capture_begin();
    CU_ASSERT_FALSE(commit());
    capture_end();
    CU_ASSERT_TRUE(said("store-cannot-write") && said("fails.db"));
    EXPECT("red 2-3 no-store");
    disk_close(disk);
    CU_ASSERT_EQUAL(life_begin("fails.db", WALL * 2), 0);
    CU_ASSERT_EQUAL(story_status().waiting, 1);
    disk_close(disk);
}

static void test_a_mail_that_is_never_due_comes_back(void)
{
    CU_ASSERT_EQUAL(life_begin("never.db", WALL), 0);
    story_join("red");
    story_join("green");
    muster_Mail m = letter("red", 1, "green", "x");
    m.level = muster_LEVEL_LOGGED;
    m.due_ns = INT64_MAX;
    story_mail(m);
    CU_ASSERT_TRUE(commit());
    disk_close(disk);
    CU_ASSERT_EQUAL(life_begin("never.db", WALL * 2), 0);
    const struct mail *got =
        journal_find(&story.b->journal, registry_find(&story.b->registry, "red"), 1);
    CU_ASSERT_PTR_NOT_NULL_FATAL(got);
    CU_ASSERT_EQUAL(got->letter.due_ns, INT64_MAX);
    disk_close(disk);
}

/* --- bundles ---------------------------------------------------------------------------------- */

enum { BUNDLED_MAX = 8192, READERS = 2 };

/* Who waits for what, as it should be. */
static struct {
    uint64_t seq[READERS][BUNDLED_MAX]; /* in order */
    uint32_t first[READERS], end[READERS];
    uint64_t sent;
} bundled;

static const char *bundled_content(uint64_t seq)
{
    static char text[600];
    int len = snprintf(text, sizeof text, "%llu \"\\\x01\t\xc3\xa4\xff\n", (unsigned long long)seq);
    memset(text + len, 'x', (size_t)(seq * 37 % 500));
    text[(size_t)len + (size_t)(seq * 37 % 500)] = '\0';
    return text;
}

static void bundled_send(unsigned whom)
{
    static const char *const to[] = {"green", "blue", "blue,green"};
    uint64_t seq = ++bundled.sent;
    muster_Mail m = letter("red", seq, to[whom % 3], bundled_content(seq));
    m.level = muster_LEVEL_LOGGED;
    story_mail(m);
    for (unsigned i = 0; i < READERS; i++) {
        if (whom % 3 == i || whom % 3 == 2) {
            bundled.seq[i][bundled.end[i]++] = seq;
        }
    }
}

/* @return how many wait for a mail */
static uint32_t bundled_waiting(uint64_t seq)
{
    uint32_t waiting = 0;
    for (unsigned i = 0; i < READERS; i++) {
        for (uint32_t k = bundled.first[i]; k < bundled.end[i]; k++) {
            waiting += bundled.seq[i][k] == seq;
        }
    }
    return waiting;
}

static void bundled_check(void)
{
    uint32_t red = registry_find(&story.b->registry, "red");
    for (uint64_t seq = 1; seq <= bundled.sent; seq++) {
        const struct mail *m = journal_find(&story.b->journal, red, seq);
        uint32_t waiting = bundled_waiting(seq);
        CU_ASSERT_EQUAL_FATAL(m != NULL, waiting > 0);
        if (m) {
            CU_ASSERT_EQUAL(m->posts.count, waiting);
            CU_ASSERT_STRING_EQUAL(m->letter.content, bundled_content(seq));
        }
    }
}

static void bundled_acknowledge(const char *name, unsigned reader, uint32_t count)
{
    uint32_t left = bundled.end[reader] - bundled.first[reader];
    uint32_t taken = count < left ? count : left;
    uint32_t agent = registry_find(&story.b->registry, name);
    uint64_t upto = mailbox_box(&story.b->mailbox, agent)->acked + taken;
    (void)story_collect();
    if (taken > 0) {
        story_ack(name, upto);
        bundled.first[reader] += taken;
    }
}

/* Mails of one commit are a bundle on disk, and some of it are settled before others: in many lives
 * of a broker each mail is back that somebody waits for, and no other. */
static void test_bundles_come_back_in_part(void)
{
    srand(7);
    memset(&bundled, 0, sizeof bundled);
    for (unsigned life = 0; life < 12; life++) {
        CU_ASSERT_EQUAL_FATAL(life_begin("bundles.db", WALL + life), 0);
        bundled_check();
        story_join("red");
        story_join("green");
        story_join("blue");
        for (unsigned round = 0; round < 6; round++) {
            unsigned count = (unsigned)rand() % (round == 3 ? 300 : 40);
            for (unsigned i = 0; i < count; i++) {
                bundled_send((unsigned)rand());
            }
            (void)commit();
            bundled_acknowledge("green", 0, (uint32_t)rand() % 120);
            bundled_acknowledge("blue", 1, (uint32_t)rand() % 120);
            (void)commit();
        }
        disk_close(disk);
    }
    CU_ASSERT_TRUE(bundled.sent > 1000);
    CU_ASSERT_EQUAL(life_begin("bundles.db", 2 * WALL), 0);
    bundled_check();
    disk_close(disk);
}

static void test_default_path(void)
{
    char path[64];
    setenv("XDG_STATE_HOME", "/state", 1);
    CU_ASSERT_TRUE(disk_default_path(path, sizeof path, 7, "main"));
    CU_ASSERT_STRING_EQUAL(path, "/state/muster/7-main.db");
    setenv("XDG_STATE_HOME", "not/absolute", 1);
    setenv("HOME", "/home/a", 1);
    CU_ASSERT_TRUE(disk_default_path(path, sizeof path, 7, "main"));
    CU_ASSERT_STRING_EQUAL(path, "/home/a/.local/state/muster/7-main.db");
    CU_ASSERT_FALSE(disk_default_path(path, 20, 7, "main"));
    unsetenv("HOME");
    CU_ASSERT_FALSE(disk_default_path(path, sizeof path, 7, "main"));
}

static void folder_remove(void)
{
    DIR *all = opendir(folder);
    for (const struct dirent *e; all && (e = readdir(all));) {
        unlink(file(e->d_name));
    }
    if (all) {
        closedir(all);
    }
    rmdir(folder);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"everything of a mail comes back", test_everything_of_a_mail_comes_back},
        {"capsules come back", test_capsules_come_back},
        {"what is settled stays away", test_what_is_settled_stays_away},
        {"a commit that fails leaves nothing", test_a_commit_that_fails_leaves_nothing},
        {"a mail that is never due comes back", test_a_mail_that_is_never_due_comes_back},
        {"bundles come back in part", test_bundles_come_back_in_part},
        {"default path", test_default_path},
        CU_TEST_INFO_NULL,
    };
    if (!mkdtemp(folder)) {
        return EXIT_FAILURE;
    }
    int result = suite_run("disk", tests);
    folder_remove();
    return result;
}
