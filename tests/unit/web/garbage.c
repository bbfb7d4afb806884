/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Damaged recordings, to the page's slider: whatever the wounds, the scene is shown, and moments,
 * tracks and causes are answered, or there are none.  A recording's memory is for the life of a
 * process: children look at some each.  From another seed where MUSTER_SEED names one, and so many
 * times as MUSTER_ROUNDS says: make soak-strangers.
 */
#include "rich_recording.h"
#include "suite.h"
#include "web/web.h"

#include <sys/wait.h>

enum { ROUNDS = 300, A_CHILD = 20, CHILD_S = 60 };

static struct rich_recording rich;

/* @return whether each answer is a text, or none */
static bool past_ask(struct past *p)
{
    static const char *const names[] = {"red", "blue", "nobody", ""};
    static struct board board;
    board_init(&board);
    past_show(p, &board);
    bool good = past_whole(p) != NULL;
    (void)past_tracks(p);
    for (int64_t step = -1; step < RICH_STEPS + 2; step += 2) {
        const char *name = names[(size_t)(step + 1) / 2 % 4];
        const struct mu_text *moment = past_moment(p, step, name);
        good = good && (!moment || moment->len > 0);
        (void)past_why(p, step, name);
    }
    (void)past_moment(p, INT64_MAX, "red");
    (void)past_why(p, INT64_MAX, "red");
    return good;
}

/* In a child: some recordings.  @return how many of them could be opened */
static int some_ask(struct mu_random *random, bool wounds)
{
    int opened = 0;
    for (int i = 0; i < A_CHILD; i++) {
        struct past *p = calloc(1, sizeof *p);
        struct mu_fault fault;
        bool there =
            wounds ? rich_recording_wound(&rich, random) : rich_put(&rich, rich.bytes, rich.len);
        if (there && past_open(p, rich.path, &fault) == MU_OK) {
            opened += past_ask(p);
            past_close(p);
        }
        free(p);
    }
    return opened;
}

/* @return how many could be opened; -1: the child has broken */
static int child_ask(uint64_t seed, bool wounds)
{
    int status = 0;
    pid_t child = fork();
    if (child == 0) {
        struct mu_random random;
        mu_random_seed(&random, seed, "wounded pasts");
        (void)alarm(CHILD_S);
        _exit(some_ask(&random, wounds));
    }
    bool ended = child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status);
    return ended && WEXITSTATUS(status) <= A_CHILD ? WEXITSTATUS(status) : -1;
}

static void test_the_sample_itself(void)
{
    CU_ASSERT_FATAL(rich_recording_make(&rich));
    CU_ASSERT_EQUAL(child_ask(0, false), A_CHILD);
}

static void test_wounded_pasts(void)
{
    uint64_t seed = suite_setting("MUSTER_SEED", 41);
    uint64_t rounds = suite_setting("MUSTER_ROUNDS", ROUNDS), opened = 0;
    printf("seed %llu ", (unsigned long long)seed);
    for (uint64_t round = 0; round < rounds; round += A_CHILD) {
        int count = child_ask(seed + round, true);
        CU_ASSERT(count >= 0);
        opened += count > 0 ? (uint64_t)count : 0;
    }
    CU_ASSERT(opened > rounds / 4 && opened < rounds);
}

int main(void)
{
    CU_TestInfo tests[] = {{"the sample itself", test_the_sample_itself},
                           {"wounded pasts", test_wounded_pasts},
                           CU_TEST_INFO_NULL};
    int code = suite_run("web/garbage", tests);
    unlink(rich.path);
    return code;
}
