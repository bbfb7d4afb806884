/* SPDX-License-Identifier: Apache-2.0 */
/* What the agents of a lock step say may arrive in any order: the run is the same. */
#include "broker_story.h"
#include "core/hash.h"
#include "core/random.h"

enum { PLAYERS = 6, STEPS = 40 };

static const char *const players[PLAYERS] = {"a", "b", "c", "d", "e", "f"};
static uint64_t acked[PLAYERS];
static uint64_t seqs[PLAYERS];
static uint64_t run_digest;

static void digest(const char *s)
{
    run_digest = mu_hash_bytes(run_digest, s, strlen(s));
}

/* Takes all Deliveries of a step, and digests them in order of process. */
static void step_collect(void)
{
    static char lines[PLAYERS + 1][1 << 15];
    const char *process;
    muster_Delivery d;
    memset(lines, 0, sizeof lines);
    while (broker_next(story.b, &process, &d)) {
        uint32_t at = strcmp(process, "sim") == 0 ? PLAYERS : (uint32_t)(process[2] - 'a');
        mu_text_clear(&story.text);
        story_note(&d);
        for (uint32_t i = 0; i < d.members._length; i++) {
            story_line(d.members._buffer[i].name);
        }
        snprintf(lines[at], sizeof lines[at], "%s", story.text.at);
        if (at < PLAYERS && d.parcels._length > 0) {
            acked[at] = d.parcels._buffer[d.parcels._length - 1].number;
        }
        broker_delivered(story.b, 0);
    }
    for (uint32_t i = 0; i <= PLAYERS; i++) {
        digest(lines[i]);
    }
}

/* What a player does depends on the seed, its name and the step alone. */
static void player_acts(uint32_t player, int64_t step)
{
    static const char *const targets[] = {"a", "b", "c", "d", "e", "f", "all", "a,c,e", "nobody"};
    char stream[16], content[16];
    struct mu_random r;
    snprintf(stream, sizeof stream, "%s%d", players[player], (int)step);
    snprintf(content, sizeof content, "m%d", (int)step);
    mu_random_seed(&r, 1, stream);
    muster_Mail mails[3];
    uint32_t count = (uint32_t)mu_random_between(&r, 0, 3);
    for (uint32_t i = 0; i < count; i++) {
        mails[i] =
            letter(players[player], ++seqs[player], targets[mu_random_between(&r, 0, 8)], content);
        mails[i].ttl_ns = (uint64_t)mu_random_between(&r, 0, 1) * 150 * MS;
        mails[i].due_ns = mu_random_between(&r, 0, 4) ? -1 : (int64_t)MS * 100 * (step + 3);
    }
    muster_State state = (muster_State)mu_random_between(&r, 0, 3);
    story_up(players[player], step, state, mails, count, acked[player]);
}

static void roster_say(void)
{
    char *processes[PLAYERS] = {words("p-c"), words("p-a"), words("p-b"),
                                words("p-f"), words("p-e"), words("p-d")};
    muster_Roster roster = {.simulator = words("sim"), .lockstep = true, .step_ns = 100 * MS};
    roster.processes._buffer = processes;
    roster.processes._length = PLAYERS;
    broker_roster(story.b, &roster, story.now_ns);
}

static uint64_t run_shuffled(uint64_t seed)
{
    struct mu_random r;
    story_begin();
    mu_random_seed(&r, seed, "order");
    run_digest = 14695981039346656037ull;
    memset(acked, 0, sizeof acked);
    memset(seqs, 0, sizeof seqs);
    uint32_t order[PLAYERS];
    for (uint32_t i = 0; i < PLAYERS; i++) {
        order[i] = i;
    }
    for (int64_t step = -1; step < STEPS; step++) {
        for (uint32_t i = PLAYERS; i > 1; i--) {
            uint32_t j = (uint32_t)mu_random_between(&r, 0, i - 1), swap = order[j];
            order[j] = order[i - 1];
            order[i - 1] = swap;
        }
        for (uint32_t i = 0; i < PLAYERS; i++) {
            if (step < 0) {
                story_join(players[order[i]]);
            } else {
                player_acts(order[i], step);
                story_tick((uint64_t)mu_random_between(&r, 0, 1000) * MS);
            }
        }
        if (step < 0) {
            story_match("sim");
            (void)story_collect();
            roster_say();
        }
        step_collect();
    }
    return run_digest;
}

static void test_order_of_arrival_does_not_matter(void)
{
    uint64_t first = run_shuffled(1);
    muster_BrokerStatus s = story_status();
    CU_ASSERT_TRUE(s.delivered > 100 && s.expired > 10 && s.unknown_name > 5);
    for (uint64_t seed = 2; seed <= 12; seed++) {
        CU_ASSERT_EQUAL(run_shuffled(seed), first);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the order of arrival does not matter", test_order_of_arrival_does_not_matter},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/order", tests);
}
