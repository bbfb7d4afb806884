/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/delivery/delivery.h"

#include "broker/control/parts.h"

void floods_note_speaker(struct broker *b, uint32_t place)
{
    struct floods_speaker *s = b->floods.speakers;
    uint32_t i = 0;
    while (i < FLOODS_SPEAKERS - 1 && (s[i].place != place || s[i].spoke_ns == 0)) {
        i++;
    }
    for (; i > 0; i--) {
        s[i] = s[i - 1];
    }
    s[0] = (struct floods_speaker){.place = place, .spoke_ns = b->clock.now_ns};
}

/* @return whether anybody but the two ends of a flood has mail under way */
static bool disturbs(const struct broker *b, uint32_t place)
{
    bool found = false;
    for (uint32_t i = 0; i < FLOODS_SPEAKERS && !found; i++) {
        const struct floods_speaker *s = &b->floods.speakers[i];
        bool speaks = s->spoke_ns > 0 && b->clock.now_ns - s->spoke_ns < FLOODS_QUIET_NS;
        found = speaks && s->place != place && s->place != b->places.at[place].flooded_from;
    }
    return found;
}

static bool is_flooded(const struct broker *b, uint32_t place)
{
    const struct place *at = &b->places.at[place];
    bool is_one = !at->rostered && !at->simulator && !at->is_broker;
    return at->flooded && is_one && disturbs(b, place);
}

uint32_t floods_room(const struct broker *b, uint32_t place)
{
    return is_flooded(b, place) ? FLOODS_MAILS : MU_WINDOW_MAX;
}

bool floods_hold(struct broker *b, uint32_t place)
{
    struct floods *f = &b->floods;
    struct place *at = &b->places.at[place];
    bool holds = b->clock.now_ns < at->flooded_until_ns && is_flooded(b, place);
    if (holds && !at->flood_queued) {
        at->flood_queued = true;
        at->flood_wake_ns = at->flooded_until_ns;
        f->ring[(f->head + f->count++) % MU_PROCESSES_MAX] = place;
    }
    return holds;
}

void floods_note_delivery(struct broker *b, uint32_t place, uint32_t mails, uint32_t from)
{
    struct place *at = &b->places.at[place];
    at->flooded = mails >= FLOODS_MANY;
    at->flooded_from = from;
    at->flooded_until_ns = b->clock.now_ns + FLOODS_PAUSE_NS;
}

void floods_tick(struct broker *b)
{
    struct floods *f = &b->floods;
    while (floods_deadline_ns(b) <= b->clock.now_ns) {
        uint32_t place = f->ring[f->head];
        f->head = (f->head + 1) % MU_PROCESSES_MAX;
        f->count--;
        b->places.at[place].flood_queued = false;
        places_wake(&b->places, place);
    }
}

uint64_t floods_deadline_ns(const struct broker *b)
{
    const struct floods *f = &b->floods;
    return f->count ? b->places.at[f->ring[f->head]].flood_wake_ns : UINT64_MAX;
}
