"""The parts of a stream that know nothing of grpc: what is said again, what waits for an answer, signs
of life, what waits to be sent, what is counted."""

import pytest

from arapd import ArapError, Handle, Target, _replay, _wire
from arapd._awaited import Asked, AwaitedAnswers, SignsOfLife
from arapd._replay import ReplayLog, edit, update
from arapd._stream_parts import Counts, Outbox

Request = _wire.message("StreamDeformRequest")


def moved(sequence, picks=b"", measure=False, **targets):
    places = {handle: Target(*place) for handle, place in targets.items()}
    return update(sequence, places, b"", picks, measure)


def placed(sequence, *values):
    return update(sequence, {}, _wire.packed(values))


def told(messages):
    """Each message as (sequence, what it says)."""
    out = []
    for said in messages:
        request = Request.FromString(said.data)
        if said.is_edit:
            out.append((said.sequence, "edit"))
        elif request.update.positions:
            out.append((said.sequence, _wire.numbers(request.update, "positions").tolist()))
        else:
            out.append((said.sequence, {t.handle_id: (t.x, t.y) for t in request.update.targets}))
        assert (request.edit if said.is_edit else request.update).sequence == said.sequence
    return out


def log_of(*said, latest=True):
    log = ReplayLog(latest)
    for one in said:
        log.sent(one)
    return log


def test_what_has_no_answer_is_said_again_as_it_was():
    log = log_of(moved(1, a=(1, 0)), moved(2, b=(2, 0)))
    assert told(log.messages()) == [(1, {"a": (1, 0)}), (2, {"b": (2, 0)})]


def test_what_was_answered_is_merged():
    log = log_of(moved(1, a=(1, 0)), moved(2, b=(2, 0)), moved(3, a=(3, 0)), moved(4, b=(4, 0)))
    assert log.answered(3, True)
    assert told(log.messages()) == [(3, {"a": (3, 0), "b": (2, 0)}), (4, {"b": (4, 0)})]
    assert not log.answered(3, True)


def test_a_refused_update_has_changed_nothing():
    log = log_of(moved(1, a=(1, 0)), moved(2, a=(2, 0)))
    log.answered(1, True)
    log.answered(2, False)
    assert told(log.messages()) == [(1, {"a": (1, 0)})]


def test_positions_come_between_the_targets_before_and_after_them():
    log = log_of(moved(1, a=(1, 0)), placed(2, 5, 5), moved(3, b=(3, 0)))
    log.answered(3, True)
    assert told(log.messages()) == [(1, {"a": (1, 0)}), (2, [5, 5]), (3, {"b": (3, 0)})]


def test_edits_are_kept_with_the_targets_before_them():
    log = log_of(moved(1, a=(1, 0)), edit(2, ["b"], [Handle("c", vertex=1)]), moved(3, c=(3, 0)))
    log.answered(3, True)
    assert told(log.messages()) == [(1, {"a": (1, 0)}), (2, "edit"), (3, {"c": (3, 0)})]


def test_many_updates_without_answer_become_few():
    log = log_of(*(moved(i, **{f"h{i % 3}": (i, 0)}) for i in range(1, _replay.MOST_PENDING + 1)),
                 edit(300, ["h0"], []), *(placed(i, i, i) for i in range(301, 401)))
    messages = told(log.messages())
    assert len(messages) < 150
    assert (300, "edit") in messages and messages[-1] == (400, [400, 400])
    assert [sequence for sequence, _ in messages] == sorted(sequence for sequence, _ in messages)
    every = log_of(*(moved(i, a=(i, 0)) for i in range(1, 1001)), latest=False)
    assert len(every.messages()) == 1000


def test_answers_belong_to_what_was_asked():
    awaited = AwaitedAnswers(every=False)
    assert awaited.oldest is None
    for sequence in (1, 2, 4):
        awaited.sent(moved(sequence, picks=b"\0" * 16 * sequence), 10.0 + sequence)
    assert awaited.oldest == 11.0
    assert awaited.take(2) == Asked(2, False)  # and 1 has been replaced
    with pytest.raises(ArapError, match="sequence 3"):
        awaited.take(3)
    with pytest.raises(ArapError, match="sequence 1"):
        awaited.take(1)
    assert awaited.take(4) == Asked(4, False)
    every = AwaitedAnswers(every=True)
    every.sent(moved(1), 0)
    every.sent(moved(2), 0)
    with pytest.raises(ArapError, match="sequence 2"):
        every.take(2)


def test_old_questions_are_known_as_a_range():
    awaited = AwaitedAnswers(every=False)
    for sequence in range(10_000):
        awaited.sent(moved(sequence), sequence)
    assert len(awaited._awaited) <= AwaitedAnswers.MOST_APART
    assert awaited.oldest == 0
    assert awaited.take(17).picks is None and awaited.take(18).picks is None
    assert awaited.take(9_999) == Asked(0, False)


def test_what_answers_in_the_place_of_one_that_is_to_be_measured_is_measured():
    awaited = AwaitedAnswers(every=False)
    for said in (moved(1, measure=True), moved(2), moved(3), edit(4, [], []), moved(5)):
        awaited.sent(said, 0)
    assert [awaited.take(i).measured for i in (2, 3, 4, 5)] == [True, False, True, False]

    newest = _replay.MOST_PENDING + 1  # so many that they become few
    log = log_of(*(moved(i, measure=i == 3, a=(i, 0)) for i in range(1, newest + 1)))
    messages = [Request.FromString(said.data).update for said in log.messages()]
    assert len(messages) == 2 and messages[-1].sequence == newest
    assert [update.measure for update in messages] == [False, True]
    assert log.messages()[-1].measure
    # Once it is answered it need not be measured again.
    log.answered(newest, True)
    assert not any(said.measure for said in log.messages())


def test_signs_of_life_are_asked_for_after_silence():
    life = SignsOfLife(heartbeat=5, silence=30)
    life.restart(0)
    life.set_waiting(True, 0)
    assert not life.is_due(True, 4.9) and life.is_due(True, 5)
    life.ask(None, True, 5)
    assert not life.is_due(True, 20), "one is under way"
    assert not life.is_silent(29.9) and life.is_silent(30)
    life.ask(7, True, 6)
    assert not life.answered(0)
    assert life.unanswered() == [7]
    with pytest.raises(ArapError, match="ping"):
        life.answered(8)
    assert life.answered(7)
    life.set_waiting(False, 31)
    assert not life.is_silent(1000), "nobody listens"


def test_before_the_opening_our_own_questions_come_first():
    life = SignsOfLife(5, 30)
    life.ask(7, False, 0)
    life.ask(None, False, 1)
    assert not life.answered(0)
    life.restart(2)
    assert life.unanswered() == [7]


def test_an_update_takes_the_place_of_what_it_covers():
    box = Outbox()
    for said in (moved(1, a=(1, 0)), moved(2, a=(2, 0), b=(2, 0)), moved(3, b=(3, 0)),
                 edit(4, [], []), moved(5, b=(5, 0)), placed(6, 6, 6), placed(7, 7, 7)):
        box.push(said.data, said)
    taken = []
    while (data := box.take()) is not None:
        assert box.writing_since is not None and not box.is_clear
        taken.append(Request.FromString(data))
        box.taken()
    assert box.is_clear
    sequences = [(r.edit if r.HasField("edit") else r.update).sequence for r in taken]
    assert sequences == [2, 3, 4, 5, 7], "1 is covered by 2, 6 by 7; 3 leaves the a of 2"
    asked = moved(8, picks=b"\0" * 16, a=(0, 0))
    assert not moved(9, a=(1, 1)).covers(asked), "its picks want an answer"
    measured = moved(8, measure=True, a=(0, 0))
    assert not moved(9, a=(1, 1)).covers(measured), "its shape is to be measured"
    assert moved(9, measure=True, a=(1, 1)).covers(measured)


def test_what_newer_ones_replaced_is_counted():
    counts = Counts()
    for sequence in (1, 2, 3, 5, 8):
        counts.note_sent(sequence)
    assert counts.note_answer(1, True) == 0
    assert counts.note_answer(5, True) == 2
    assert counts.note_answer(8, False) == 0
    assert (counts.sent, counts.answered, counts.refused, counts.replaced) == (5, 2, 1, 2)
    for sequence in range(10, 20_010):
        counts.note_sent(sequence)
    counts.note_answer(11, True)
    counts.note_answer(20_009, True)
    assert counts.answered + counts.refused + counts.replaced == counts.sent == 20_005
