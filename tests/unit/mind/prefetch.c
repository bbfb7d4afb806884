/* SPDX-License-Identifier: Apache-2.0 */
/* Minds that are so many that they measure what they use do what one alone does. */
#include "core/text_file.h"
#include "mind/engine/engine.h"
#include "mind/mind.h"
#include "suite.h"

#include <CUnit/Basic.h>

enum { MINDS = 140, STEPS = 60, SONARS = 16, LEAVES_AT = 17, FEW = 30 };

static struct mind *minds[MINDS];
static struct mind_act alone[STEPS];

static mu_result post(void *self, const struct mind_letter *letter)
{
    (void)self;
    (void)letter;
    return MU_OK;
}

/* Their random numbers are the same as their names are. */
static struct mind *mind_make(void)
{
    struct mind *m = NULL;
    struct mu_fault fault = {.text = ""};
    struct mind_options options = {.read = mu_text_file_read,
                                   .name = "red",
                                   .seed = 1,
                                   .rules_folder = "rules",
                                   .ports = {.send = post}};
    CU_ASSERT_EQUAL_FATAL(mind_open(&m, &options, &fault), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mind_load(m, "bench/sim/roam.clp", &fault), MU_OK);
    return m;
}

static struct mind_act step_make(struct mind *m, uint64_t step)
{
    float sonar_m[SONARS];
    for (size_t i = 0; i < SONARS; i++) {
        sonar_m[i] = 0.3F + 0.2F * (float)((step / 4 + 3 * i) % 20);
    }
    struct mu_percept percept = {.time_ns = step * MU_STEP_NS,
                                 .x_m = 0.01 * (double)step,
                                 .forward_m_s = 0.2,
                                 .sonar_count = SONARS,
                                 .sonar_m = sonar_m};
    struct mind_act act, second;
    mind_percept(m, &percept);
    mind_fire(m, &act);
    mind_fire(m, &second); /* measures nothing */
    return act;
}

static bool acts_are_same(const struct mind_act *a, const struct mind_act *b)
{
    return a->drives == b->drives && a->forward_m_s == b->forward_m_s &&
           a->turn_rad_s == b->turn_rad_s && a->firings == b->firings && a->errors == b->errors;
}

/* Known pages are pages, none of which is known twice. */
static bool pages_are_known(const struct heap *h)
{
    uint32_t wrong = h->numbers > HEAP_KNOWN || h->spares > h->numbers;
    for (uint32_t i = 0; i < h->numbers; i++) {
        for (uint32_t j = 0; j < i; j++) {
            wrong += h->known[i] && h->known[i] == h->known[j];
        }
        wrong += (uintptr_t)h->known[i] % PAGE_BYTES != 0;
    }
    return wrong == 0;
}

/* The first ones are gone after some steps, and their pages are others'. */
static void test_many_do_what_one_does(void)
{
    struct mind *one = mind_make();
    for (uint64_t s = 0; s < STEPS; s++) {
        alone[s] = step_make(one, s);
        CU_ASSERT(alone[s].errors == 0 && alone[s].firings > 0);
    }
    for (size_t i = 0; i < MINDS; i++) {
        minds[i] = mind_make();
    }
    unsigned other = 0;
    for (uint64_t s = 0; s < STEPS; s++) {
        for (size_t i = s > LEAVES_AT ? FEW : 0; i < MINDS; i++) {
            struct mind_act act = step_make(minds[i], s);
            other += !acts_are_same(&act, &alone[s]);
        }
        for (size_t i = 0; s == LEAVES_AT && i < FEW; i++) {
            mind_close(minds[i]);
        }
    }
    CU_ASSERT_EQUAL(other, 0);
    CU_ASSERT(pages_are_known(&minds[FEW]->heap));
}

/* How many lines they ask for then. */
static void test_what_they_use_is_known(void)
{
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
    CU_ASSERT_FATAL(pages_chunks() >= 16); /* prefetch.c */
    uint32_t lines = prefetch_begin(minds[MINDS - 1]);
    CU_ASSERT(lines > 100 && lines < 2000);
#endif
}

/* A mind of other rules has pages that are used for other things. */
static void test_other_rules_are_others(void)
{
    struct mind *m = NULL;
    struct mu_fault fault = {.text = ""};
    struct mind_options options = {
        .read = mu_text_file_read, .name = "red", .seed = 1, .ports = {.send = post}};
    CU_ASSERT_EQUAL_FATAL(mind_open(&m, &options, &fault), MU_OK);
    (void)step_make(m, 1);
#ifndef __SANITIZE_ADDRESS__ /* its heaps have no pages, and all one shape */
    CU_ASSERT(m->prefetch != minds[MINDS - 1]->prefetch);
#endif
    mind_close(m);
    CU_ASSERT_PTR_NULL(m->prefetch);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"many minds do what one does", test_many_do_what_one_does},
        {"what they use is known", test_what_they_use_is_known},
        {"other rules are others", test_other_rules_are_others},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/prefetch", tests);
}
