/* SPDX-License-Identifier: Apache-2.0 */
/* The table of a mind's states, and the state that those who are called back find it in. */
#include "mind/engine/engine.h"
#include "mind/mind.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* By state and event: the first letter of the next state (P: loading, G: looking), - refused, .
 * illegal. */
static const char *const table[MIND_STATES] = {
    /*                 b l s t f h l l s d f c */
    [MIND_VACANT] = "P--------..V",   [MIND_LOADING] = ".........RX.",
    [MIND_READY] = ".PSTFHLGA..V",    [MIND_SENSING] = ".........RX.",
    [MIND_TAKING] = ".........RX.",   [MIND_FIRING] = ".........RX.",
    [MIND_HANDLING] = ".........RX.", [MIND_LINE] = ".........RX.",
    [MIND_LOOKING] = ".........R..",  [MIND_SAVING] = ".........RX.",
    [MIND_FAILED] = ".--------..V"};
static const char letters[MIND_STATES + 1] = "VPRSTFHLGAX";

static bool aborts(struct mind *m, enum state_event event)
{
    int status = 0;
    pid_t child = fork();
    CU_ASSERT_FATAL(child >= 0);
    if (child == 0) {
        (void)setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
        (void)close(STDERR_FILENO);
        (void)state_on(m, event);
        _exit(0);
    }
    CU_ASSERT_EQUAL(waitpid(child, &status, 0), child);
    return !WIFEXITED(status) || WEXITSTATUS(status) != 0;
}

static void check(struct mind *m, int state, int event)
{
    char want = table[state][event];
    m->state = (enum mind_state)state;
    uint64_t refused = m->refused_calls;
    if (want == '.') {
        CU_ASSERT(aborts(m, (enum state_event)event));
        return;
    }
    CU_ASSERT_EQUAL(state_on(m, (enum state_event)event), want != '-');
    CU_ASSERT_EQUAL(letters[m->state], want == '-' ? letters[state] : want);
    CU_ASSERT_EQUAL(m->refused_calls - refused, want == '-');
}

static void test_the_whole_table(void)
{
    struct mind *m = mind_reserve();
    CU_ASSERT_EQUAL(m->state, MIND_VACANT);
    for (int state = 0; state < MIND_STATES; state++) {
        CU_ASSERT_EQUAL(strlen(table[state]), STATE_EVENTS);
        for (int event = 0; event < STATE_EVENTS; event++) {
            check(m, state, event);
        }
    }
}

static struct mind *mind;
static int called;
static enum mind_state found;
static bool limited;

static void print(void *self, const char *text)
{
    (void)self;
    (void)text;
    called++;
    found = mind->state;
    limited = state_is_limited(mind);
}

/* What a handler complains of is shown behind it, while the others wait for their turn. */
static void test_a_call_of_handlers_is_one_call(void)
{
    static const char rules[] =
        "(deffunction good (?id ?from ?performative ?content) FALSE)\n"
        "(deffunction bad (?id ?from ?performative ?content) (+ ?from 1) FALSE)\n"
        "(on-layer 4 good) (on-layer 4 bad)\n";
    const struct mind_options options = {.name = "red", .seed = 1, .ports.print = print};
    const struct mind_mail mail = {.src = "blue",
                                   .performative = "tell",
                                   .language = "clips",
                                   .ontology = "",
                                   .reply_with = "",
                                   .in_reply_to = "",
                                   .conversation = "",
                                   .content = "near",
                                   .layer = 4};
    struct mu_fault fault;
    CU_ASSERT_EQUAL_FATAL(mind_open(&mind, &options, &fault), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mind_load_text(mind, "rules", rules, &fault), MU_OK);
    CU_ASSERT_FALSE(mind_handle(mind, &mail));
    CU_ASSERT(called > 0);
    CU_ASSERT_EQUAL(found, MIND_HANDLING);
    CU_ASSERT(limited);
    CU_ASSERT_EQUAL(mind->state, MIND_READY);
    mind_close(mind);
    CU_ASSERT_EQUAL(mind->state, MIND_VACANT);
    CU_ASSERT_FALSE(mind_handle(mind, &mail));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the whole table", test_the_whole_table},
        {"a call of handlers is one call", test_a_call_of_handlers_is_one_call},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/state", tests);
}
