/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file up.h
 * A sample of the type that mail goes to the broker in, with one mail: for what is measured over
 * DDS without a broker.
 */
#ifndef BENCH_UP_H
#define BENCH_UP_H

#include "bus/bus.h"
#include "wire.h"

struct bench_up {
    muster_Mail mail;
    muster_Act act;
    muster_Up up;
};

/** Puts it together where it is to stay.  @param content  stays the caller's */
static inline void bench_up_fill(struct bench_up *b, uint64_t seq, int64_t step, char *content)
{
    /* idlc's members are not const, though nobody writes to them here. */
    static char me[] = "bench", to[] = "echo", none[] = "";
    b->mail = (muster_Mail){.src = me,
                            .seq = seq,
                            .dst = to,
                            .layer = 3,
                            .performative = none,
                            .language = none,
                            .ontology = none,
                            .reply_with = none,
                            .in_reply_to = none,
                            .conversation = none,
                            .due_ns = -1,
                            .content = content};
    b->act = (muster_Act){
        .agent = me, .rules = none, .mails = {._maximum = 1, ._length = 1, ._buffer = &b->mail}};
    b->up = (muster_Up){
        .process = me, .step = step, .acts = {._maximum = 1, ._length = 1, ._buffer = &b->act}};
}

#endif
