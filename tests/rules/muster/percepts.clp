; SPDX-License-Identifier: Apache-2.0
; The fact of the sonars, of which no rule here has a pattern: there for whoever looks, and once.
(deffunction rings-listed ()
  (bind ?n 0)
  (foreach ?f (get-fact-list)
    (if (eq (fact-relation ?f) sonar) then (bind ?n (+ ?n 1))))
  ?n)

(defrule look
  (looks ?how) (position ?time $?)
  =>
  (if (eq ?how findall) then
    (printout t "findall " (length$ (findall (sonar ?time $?))) " " (rings-listed) crlf))
  (if (eq ?how list) then
    (printout t "list " (rings-listed) " " (length$ (findall (sonar $?))) crlf))
  (if (eq ?how build) then
    (build "(defrule late (sonar ?t $?) => (printout t \"late \" ?t crlf))")))

; step: sonar=5000
; line: (rings-listed)
; expect: 1
; line: (do-for-all-facts ((?f sonar)) TRUE (printout t "query " (length$ (fact-fields ?f)) crlf))
; expect: query 17
; steps: 3
; line: (length$ (findall (sonar $?)))
; expect: 1
; line: (assert (looks findall))
; expect: <Fact-9>
; step:
; expect: findall 1 1
; line: (do-for-all-facts ((?f looks)) TRUE (retract ?f))
; line: (assert (looks list))
; expect: <Fact-12>
; step:
; expect: list 1 1
; line: (reset)
; line: (rings-listed)
; expect: 0
; line: (assert (looks build))
; expect: <Fact-1>
; step:
; expect: late 0.6
