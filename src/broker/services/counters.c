/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/services.h"

#include "broker/control/parts.h"
#include "core/text.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

_Static_assert((int)PARTS_END == (int)REGISTRY_OWN, "each part has its line in the white pages");

static const struct {
    const char *name, *job;
} parts[PARTS_END] = {
    [0] = {"broker", "all of them"},
    [PART_REGISTRAR] = {"registrar", "who bears which name, in which process, in which state"},
    [PART_POSTMASTER] = {"postmaster", "a mail's way into boxes, and what becomes of it"},
    [PART_COURIER] = {"courier", "what is ready for a process, as one delivery"},
    [PART_GROUPS] = {"groups", "who is a member of what"},
    [PART_SERVICES] = {"services", "the yellow pages"},
    [PART_TRUST] = {"trust", "whose directives are carried out"},
    [PART_JOURNAL] = {"journal", "what must be on disk before anybody is told"},
    [PART_LIAISON] = {"liaison", "the other brokers"},
};

static uint64_t oldest_ns(const struct broker *b)
{
    return ages_oldest_ns(&b->ages, runclock_mail_ns(&b->clock));
}

static uint64_t refused(const struct broker *b)
{
    return b->counters.refused + b->counters.unspoken;
}

#define AT(member) \
    .offset = offsetof(struct broker, member), .size = sizeof((struct broker *)0)->member

/* Mails are counted per receiver. */
static const struct counter counters[] = {
    {PART_REGISTRAR, "agents", "agents that are there now", AT(registry.present)},
    {PART_REGISTRAR, "names", "names ever registered, the broker and its parts included",
     AT(registry.count)},
    {PART_REGISTRAR, "processes", "processes that it serves now", AT(places.used_count)},
    {PART_REGISTRAR, "claims", "names that another process waits for now", AT(claims.count)},
    {PART_REGISTRAR, "capsules", "capsules of agents on their way that it keeps now",
     AT(depot.count)},
    {PART_REGISTRAR, "capsules-kept", "of them, ever", AT(depot.kept)},
    {PART_REGISTRAR, "capsules-refused", "of them, whose agents stayed", AT(depot.refused)},
    {PART_REGISTRAR, "capsules-restored", "of them, given to a host because nobody had the agent",
     AT(depot.restored)},
    {PART_REGISTRAR, "changes", "changes of the white pages", AT(registry.changes.version)},

    {PART_POSTMASTER, "sent", "mails, one a receiver", AT(counters.sent)},
    {PART_POSTMASTER, "delivered", "of them, acknowledged", AT(counters.delivered)},
    {PART_POSTMASTER, "waiting", "of them, in a box now", AT(counters.waiting)},
    {PART_POSTMASTER, "expired", "of them, older than they might become", AT(counters.expired)},
    {PART_POSTMASTER, "dropped", "of them, taken out of a full box for others",
     AT(counters.dropped)},
    {PART_POSTMASTER, "box-full", "of them, refused for want of room", AT(counters.box_full)},
    {PART_POSTMASTER, "over-share", "of them, refused for their sender's share",
     AT(counters.over_share)},
    {PART_POSTMASTER, "unknown-name", "of them, to a name that nobody ever had",
     AT(counters.unknown_name)},
    {PART_POSTMASTER, "refused", "of them, directives that the policy does not allow",
     AT(counters.refused)},
    {PART_POSTMASTER, "no-store", "of them, refused for want of a disk that can be written to",
     AT(counters.no_store)},
    {PART_POSTMASTER, "resolving", "mails that wait for an address to be resolved, now",
     AT(resolve.waiting)},
    {PART_POSTMASTER, "resolve-asked", "addresses that a resolver was asked about",
     AT(resolve.asked)},
    {PART_POSTMASTER, "resolve-refused", "answers of resolvers that were not asked, or too late",
     AT(resolve.refused)},
    {PART_POSTMASTER, "duplicates-dropped", "mails that came twice from their sender",
     AT(counters.duplicates_dropped)},
    {PART_POSTMASTER, "receipts-lost", "words on mails that were not told, for want of room",
     AT(receipts.lost)},
    {PART_POSTMASTER, "gaps",
     "mails not taken yet, for an earlier one of their sender or box is missing",
     AT(counters.gaps)},
    {PART_POSTMASTER, "acks-astray",
     "acknowledgements that were for an earlier life of the broker, and not counted",
     AT(counters.astray)},
    {PART_POSTMASTER, "malformed", "samples and mails that break a rule of the wire",
     AT(counters.malformed)},
    {PART_POSTMASTER, "stored", "mails kept now, each once", AT(store.mails)},
    {PART_POSTMASTER, "oldest-ns", "age of the oldest mail that waits, in nanoseconds",
     .drifts = true, .read = oldest_ns},

    {PART_COURIER, "deliveries", "samples written to processes", AT(courier.count.deliveries)},
    {PART_COURIER, "circulars", "of them, those written once for many processes",
     AT(courier.count.circulars)},
    {PART_COURIER, "parcels", "mails in them", AT(courier.count.parcels)},
    {PART_COURIER, "most-parcels", "mails in the fullest of them", AT(courier.count.most_parcels)},
    {PART_COURIER, "resent", "mails handed out again, for want of an acknowledgement",
     AT(counters.resent)},
    {PART_COURIER, "blocked", "times that the network did not take a delivery",
     AT(courier.count.blocked)},
    {PART_COURIER, "interval-ns", "the delivery interval, in nanoseconds; 0: at once",
     AT(courier.interval_ns)},
    {PART_COURIER, "wakings", "times that it woke to deliver, at an interval",
     AT(courier.count.wakings)},
    {PART_COURIER, "delay-ns", "what the interval has added to all mails together, in nanoseconds",
     AT(courier.count.delay_ns)},

    {PART_GROUPS, "groups", "groups that are there now", AT(pages.groups.groups_now)},
    {PART_GROUPS, "members", "memberships that hold now", AT(pages.groups.members_now)},
    {PART_GROUPS, "lines", "lines of the table in use now, those that hold no longer included",
     AT(pages.groups.pairs.count)},
    {PART_GROUPS, "changes", "changes of groups", AT(pages.groups.changes.version)},

    {PART_SERVICES, "offers", "services offered now, those of absent agents included",
     AT(pages.services.offers_now)},
    {PART_SERVICES, "subscriptions", "standing queries now", AT(pages.subscriptions.count)},
    {PART_SERVICES, "lines", "lines of the table in use now, those withdrawn included",
     AT(pages.services.pairs.count)},
    {PART_SERVICES, "changes", "changes of services", AT(pages.services.changes.version)},

    {PART_TRUST, "lines", "lines of the policy", AT(trust.lines_count)},
    {PART_TRUST, "allowed",
     "directives let through, one a receiver, and changes in another agent's name",
     AT(counters.directed)},
    {PART_TRUST, "refused", "of both, refused", .read = refused},
    {PART_TRUST, "glances", "lines that only look, let through outside of every step",
     AT(glances.asked)},
    {PART_TRUST, "glances-declined", "lines that only look, and came back without an answer",
     AT(glances.declined)},
    {PART_TRUST, "glances-lost", "of them, those that were not told, because too many waited",
     AT(glances.lost)},
    {PART_TRUST, "audited", "records for the audit log", AT(audit.recorded)},
    {PART_TRUST, "audit-lost", "records lost, because too many waited", AT(audit.lost)},
    {PART_TRUST, "audit-failed", "records that could not be written", AT(audit.failed)},

    {PART_JOURNAL, "commits", "transactions that are on disk", AT(journal.commits)},
    {PART_JOURNAL, "failures", "transactions that failed", AT(journal.failures)},

    {PART_LIAISON, "peers", "other brokers that are there now", AT(liaison.peers_there)},
    {PART_LIAISON, "announced", "parts of the white pages told to them",
     AT(liaison.count.announced)},
    {PART_LIAISON, "parcels-in", "mails taken from them", AT(liaison.count.parcels_in)},
    {PART_LIAISON, "repeated", "mails that came from them once more", AT(liaison.count.repeated)},
    {PART_LIAISON, "passed-on", "of the mails sent, those that they have taken over",
     AT(liaison.count.passed_on)},
    {PART_LIAISON, "receipts-in", "receipts that came from them", AT(liaison.count.receipts_in)},
    {PART_LIAISON, "clashes", "agents that had to give their name to one that had it before",
     AT(liaison.count.clashes)},
    {PART_LIAISON, "hops-refused", "mails that had passed too many brokers",
     AT(liaison.count.hops_refused)},
};

enum { COUNTERS = sizeof counters / sizeof counters[0] };

_Static_assert((int)COUNTERS <= (int)COUNTERS_MAX, "every counter has its place");

const char *counters_part_name(uint32_t part)
{
    return part < PARTS_END ? parts[part].name : NULL;
}

const struct counter *counters_at(size_t index)
{
    return index < COUNTERS ? &counters[index] : NULL;
}

uint64_t counters_value(const struct broker *b, const struct counter *c)
{
    if (c->read) {
        return c->read(b);
    }
    uint32_t small = 0;
    uint64_t large = 0;
    const char *at = (const char *)b + c->offset;
    memcpy(c->size == sizeof small ? (void *)&small : (void *)&large, at, c->size);
    return large + small;
}

void counters_print(void)
{
    enum counters_part part = 0;
    for (size_t i = 0; i < COUNTERS; i++) {
        const struct counter *c = &counters[i];
        if (c->part != part) {
            part = c->part;
            printf("\n## broker.%s: %s\n\n| Counter | What it counts |\n| --- | --- |\n",
                   parts[part].name, parts[part].job);
        }
        printf("| `%s` | %s |\n", c->name, c->counts);
    }
}

void counters_answer(struct broker *b, uint32_t own, const struct mail *question)
{
    struct mu_text t;
    if (names_in_lockstep(b, question->sender)) {
        answer_begin(b, &t, "in-lock-step");
        answer_reply(b, own, question, "failure", b->text);
        return;
    }
    answer_begin(b, &t, counters_part_name(own));
    const struct counter *c;
    for (size_t i = 0; (c = counters_at(i)); i++) {
        if (own == REGISTRY_BROKER) {
            mu_text_format(&t, " %s.%s %" PRIu64, counters_part_name(c->part), c->name,
                           counters_value(b, c));
        } else if (c->part == own) {
            mu_text_format(&t, " %s %" PRIu64, c->name, counters_value(b, c));
        }
    }
    MU_ASSERT(!t.cut);
    answer_reply(b, own, question, "inform", b->text);
}
