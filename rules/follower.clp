; SPDX-License-Identifier: Apache-2.0
;
; A robot of the follow experiment.  All that it does is in the library: it stands by until somebody
; says (wander) or (follow NAME), on its console or by (you-do blue follow red).

(deffacts standby
  (goal stay))
