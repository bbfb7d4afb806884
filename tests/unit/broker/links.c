/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Random histories of three brokers whose links are cut and lose what crosses them, while agents
 * move, against what docs/federation.md promises as long as the brokers live: each mail arrives,
 * once, and nobody is told `delivered` before.  Some agents hear multicasts, from some time on.
 *
 *     MUSTER_SEED=N       that history alone; MUSTER_TELL=1 tells it while it goes on
 *     MUSTER_SECONDS=N    so long, with other seeds than by default
 */
#include "broker_net.h"
#include "core/clock.h"
#include "core/random.h"

#include <stdarg.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum { STEPS = 200, MAILS = 256, QUIET_ROUNDS = 60 };

static struct mu_random dice;
static uint64_t seed;

static struct letter {
    struct net_agent *from, *to; /* the first of those whom it is for */
    uint64_t seq;
    uint32_t meant, heard; /* sets of agents: a bit for each */
    bool told;
} letters[MAILS];
static uint32_t letters_count;
static uint64_t *multicasts; /* of all histories: shared with them */
static bool was_mute;        /* receipts were lost */

static uint32_t roll(uint32_t sides)
{
    return (uint32_t)mu_random_between(&dice, 0, (int64_t)sides - 1);
}

static void note(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void note(const char *format, ...)
{
    if (!getenv("MUSTER_TELL")) {
        return;
    }
    va_list args;
    va_start(args, format);
    fprintf(stderr, "    %llu ms: ", (unsigned long long)(net.now_ns / MS));
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
}

static _Noreturn void fail(const char *what, uint32_t letter)
{
    printf("\n  seed %llu at %llu ms: letter %lu from %s to %s %s\n", (unsigned long long)seed,
           (unsigned long long)(net.now_ns / MS), (unsigned long)letter,
           letter < MAILS ? letters[letter].from->name : "?",
           letter < MAILS ? letters[letter].to->name : "?", what);
    fflush(stdout);
    _Exit(EXIT_FAILURE);
}

/* --- what happens ----------------------------------------------------------------------------- */

static struct net_agent *any_agent(void)
{
    return &net.agents[roll(net.agents_count)];
}

/* Sends to all of a set. */
static void letter_send(uint32_t meant)
{
    char content[16], dst[256] = "";
    struct letter *l = &letters[letters_count];
    *l = (struct letter){.from = any_agent(), .meant = meant};
    for (uint32_t i = net.agents_count; i > 0; i--) {
        struct net_agent *a = &net.agents[i - 1];
        if (meant & 1u << (i - 1)) {
            size_t len = strlen(dst);
            snprintf(dst + len, sizeof dst - len, "%s%s", len ? "," : "", a->name);
            l->to = a;
        }
    }
    l->seq = l->from->seq + 1;
    snprintf(content, sizeof content, "%lu", (unsigned long)letters_count);
    note("%s at %d sends %s to %s", l->from->name, l->from->at, content, dst);
    letters_count++;
    net_send(l->from->name, dst, content);
}

static void act_send(void)
{
    for (uint32_t many = 1 + roll(3); many > 0 && letters_count < MAILS; many--) {
        letter_send(1u << roll(net.agents_count));
    }
}

static void act_send_many(void)
{
    uint32_t all = (1u << net.agents_count) - 1;
    for (uint32_t many = 1 + roll(2); many > 0 && letters_count < MAILS; many--) {
        letter_send(roll(2) ? all : all & ~(1u << roll(net.agents_count)));
    }
}

static void act_hear(void)
{
    struct net_agent *a = any_agent();
    note("%s hears the circulars of %d", a->name, a->at);
    net_hear(a);
}

static void act_link(void)
{
    int i = (int)roll(NET_BROKERS), j = (i + 1) % NET_BROKERS;
    note("%d and %d %s", i, j, net.link[i][j] ? "are cut off" : "hear each other");
    net_link(i, j, !net.link[i][j]);
}

static void act_disturb(void)
{
    bool *const what[] = {net.deaf, net.twice, net.faint};
    bool *one = &what[roll(3)][roll(NET_BROKERS)];
    *one = !*one;
    note("deaf %d%d%d twice %d%d%d faint %d%d%d", net.deaf[0], net.deaf[1], net.deaf[2],
         net.twice[0], net.twice[1], net.twice[2], net.faint[0], net.faint[1], net.faint[2]);
}

static void act_mute(void)
{
    int i = (int)roll(NET_BROKERS);
    note("%d %s", i, net.mute[i] ? "is heard again" : "is not heard");
    net_mute(i, !net.mute[i]);
    was_mute = true;
}

/* Its broker loses it, and it goes to another one. */
static void act_move(void)
{
    struct net_agent *a = any_agent();
    int from = a->at, to = (from + 1 + (int)roll(NET_BROKERS - 1)) % NET_BROKERS;
    note("%s moves from %d to %d", a->name, from, to);
    broker_matched(net.b[from], a->process, false, net.now_ns);
    broker_gone(net.b[from], a->process, 0, true, net.now_ns);
    net_move(a->name, to);
}

/* --- what must hold --------------------------------------------------------------------------- */

static void heard_take(struct net_agent *a)
{
    char *at = a->heard;
    uint32_t one = 1u << (a - net.agents);
    while (*at) {
        uint32_t letter = (uint32_t)strtoul(at, &at, 10);
        note("%s hears %lu", a->name, (unsigned long)letter);
        if (letter >= letters_count || !(letters[letter].meant & one)) {
            fail("came to another one", letter);
        }
        if (letters[letter].heard & one) {
            fail("came twice", letter);
        }
        letters[letter].heard |= one;
        at += strspn(at, "; ");
    }
    a->heard[0] = '\0';
}

/* @return whether it may be told to be delivered; of one to many, whoever has taken over some of
 * them says so for these */
static bool has_arrived(const struct letter *l)
{
    bool is_to_one = (l->meant & (l->meant - 1)) == 0;
    return is_to_one ? l->heard == l->meant : l->heard != 0;
}

static void outcome_take(const struct net_agent *a, uint64_t first, uint64_t last, const char *word)
{
    bool delivered = strncmp(word, "delivered", 9) == 0;
    bool waits = strncmp(word, "stored", 6) == 0 || strncmp(word, "duplicate", 9) == 0;
    for (uint32_t i = 0; i < letters_count; i++) {
        struct letter *l = &letters[i];
        if (l->from != a || l->seq < first || l->seq > last) {
            continue;
        }
        l->told = true;
        if (delivered && !has_arrived(l)) {
            fail("was told to be delivered", i);
        }
        if (!delivered && !waits) {
            fail(word, i);
        }
    }
}

static void told_take(struct net_agent *a)
{
    char *at = a->told;
    while (*at) {
        uint64_t first = strtoull(at, &at, 10);
        uint64_t last = strtoull(at + 1, &at, 10);
        outcome_take(a, first, last, at + 1);
        at += strcspn(at, ";");
        at += strspn(at, "; ");
    }
    a->told[0] = '\0';
}

static void pass(uint64_t later_ns)
{
    net_tick(later_ns);
    for (uint32_t i = 0; i < net.agents_count; i++) {
        heard_take(&net.agents[i]);
    }
    for (uint32_t i = 0; i < net.agents_count; i++) {
        told_take(&net.agents[i]);
    }
}

static void grow_quiet(void)
{
    note("it grows quiet");
    memset(net.deaf, 0, sizeof net.deaf);
    memset(net.twice, 0, sizeof net.twice);
    memset(net.faint, 0, sizeof net.faint);
    for (int i = 0; i < NET_BROKERS; i++) {
        int j = (i + 1) % NET_BROKERS;
        if (net.mute[i]) {
            net_mute(i, false);
        }
        if (!net.link[i][j]) {
            net_link(i, j, true);
        }
    }
    for (int i = 0; i < QUIET_ROUNDS; i++) {
        pass(200 * MS);
    }
    for (uint32_t i = 0; i < letters_count; i++) {
        if (letters[i].heard != letters[i].meant) {
            fail("never came", i);
        }
        if (!letters[i].told && !was_mute) {
            fail("has no outcome", i);
        }
    }
    for (int i = 0; i < NET_BROKERS; i++) {
        if (net.b[i]->mailbox.posts_pool.live > 0 || net.b[i]->multicast.count > 0) {
            fail("is the last, and some mail stays", letters_count - 1);
        }
    }
}

static void history_live(void)
{
    static void (*const acts[])(void) = {act_send, act_send,      act_send, act_send,   act_send,
                                         act_send, act_send_many, act_hear, act_hear,   act_hear,
                                         act_link, act_move,      act_mute, act_disturb};
    static const char *const names[] = {"red",  "green", "blue",  "white",
                                        "grey", "black", "brown", "pink"};
    static const uint64_t passes_ms[] = {0, 1, 5, 20, 100, 300, 1100};
    mu_random_seed(&dice, seed, "links");
    net_begin();
    net.b[1]->good_news.pause_ns = LIMITER_GOOD_PAUSE_NS;
    for (int i = 0; i < NET_BROKERS; i++) {
        net_link(i, (i + 1) % NET_BROKERS, true);
    }
    for (int i = 0; i < NET_AGENTS; i++) {
        struct net_agent *a = net_join(names[i], i < NET_AGENTS - 2 ? 0 : i % NET_BROKERS);
        if (roll(4)) {
            net_hear(a);
        }
    }
    pass(1000 * MS);
    for (uint32_t i = 0; i < STEPS; i++) {
        acts[roll(sizeof acts / sizeof acts[0])]();
        pass(passes_ms[roll(7)] * MS);
    }
    grow_quiet();
    *multicasts += net.multicasts;
}

/* Each history is a process of its own.  @return whether all was as promised */
static bool live(void)
{
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        history_live();
        _Exit(EXIT_SUCCESS);
    }
    int status = 0;
    bool ended = child > 0 && waitpid(child, &status, 0) == child;
    if (ended && WIFSIGNALED(status)) {
        printf("\n  seed %llu: killed by signal %d\n", (unsigned long long)seed, WTERMSIG(status));
    }
    return ended && WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS;
}

static void test_links(void)
{
    uint64_t wanted = suite_setting("MUSTER_SEED", 0), seconds = suite_setting("MUSTER_SECONDS", 0);
    uint64_t until_ns = mu_clock_ns() + (seconds ? seconds : 3) * 1000 * MS;
    uint32_t histories = 0, failures = 0;
    multicasts =
        mmap(NULL, sizeof *multicasts, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CU_ASSERT_TRUE_FATAL(multicasts != MAP_FAILED);
    seed = wanted ? wanted : seconds ? mu_clock_wall_ns() / 1000 : 1;
    do {
        failures += !live();
        histories++;
        seed++;
    } while (!wanted && mu_clock_ns() < until_ns && failures < 3);
    CU_ASSERT_EQUAL(failures, 0);
    CU_ASSERT_TRUE(wanted || *multicasts > 0);
    printf("\n  %lu histories, %llu circulars\n", (unsigned long)histories,
           (unsigned long long)*multicasts);
}

int main(void)
{
    CU_TestInfo tests[] = {{"random links", test_links}, CU_TEST_INFO_NULL};
    return suite_run("broker/links", tests);
}
