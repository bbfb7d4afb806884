; SPDX-License-Identifier: Apache-2.0
;
; The shop of examples/kinds.c in rules: a layer of its own, 4, above the three predefined ones.

(deffunction shop (?id ?from ?performative ?content)
  (switch ?performative
    (case cfp then (reply-as ?id propose price 10))
    (case give-back then (reply-as ?id refuse give-back))
    (default FALSE)))

(on-layer 4 shop)
