"""Records as commit aec6c7c wrote them to SQLite and to Redis, literally, and its answers.

Stored records outlive a release, so that each release has to read those of the last.
"""

import re

SQLITE_SCHEMA = """
CREATE TABLE front (number INTEGER PRIMARY KEY, kept REAL, id, caller, request_id, status,
key, digest, problem, members, tours, ends, angles, kind, body, upload);
CREATE TABLE gone (number INTEGER PRIMARY KEY, id, caller);
"""

SQLITE_ROWS = [
    {
        "number": 1,
        "kept": 1000.0,
        "id": "done",
        "caller": "us",
        "request_id": "r1",
        "status": "done",
        "key": "k",
        "digest": "d1",
        "problem": b"null",
        "members": b'{"cities":3,"points":3,"hypervolume":0.2777777777777778,"hypervolume_bound":'
        b'null,"reference_point":[3.0,3.0],"scale":[1.0,1.0],"timings_ms":{"queue":198'
        b'.125,"construction":1.5,"improvement":50.25,"selection":0.125,"bound":0.0,"t'
        b'otal":250.0},"terminated":"time_limit","actor":{"name":"pa-one","digest":"ab'
        b'12"},"places":[[0,0],[0,1],[1,0]]}',
        "tours": b"x\x01u\xcd=\n\xc30\x0c\x05\xe0\xbbh\x16Fr\xeb\xdf\xab\x14\x0f!\x98d"
        b"p\xd3\x92\xba\x93\xc9\xdd#\x97\x14\x02\xa5\x8b@z\x0f}\r\x86e*\x19\xa2\xf5"
        b"\x8a\x837\x81\x0c_\xec\xd5\xb3G(y\x99\xea\xfc\x82xcE\xa8\x95I\x08\xf5"
        b"\xf1^\xe5@\xc8\xa8e}\x0eu\x86\xd8`\xcc\xa5\xf4\xa2\x04\x94\xb0\xc7\x9fII"
        b":\xf7\\\xd7,\xa1<\xd96l_P[e\xac\x11\x8e\x9d#\xe7B8\x83Z@\xe9\x9fA"
        b"\xdd\x7f\xfe\x03\xf9`\x7f\xc1\x1d[\xf6>\xa5",
        "ends": b"p\x00\x00\x00\x00\x00\x00\x00\xe1\x00\x00\x00\x00\x00\x00\x00",
        "angles": b"\x8cZ\xfc\xb4\xb5\x0cQ@\xc4\x1d\xa61\xa7\x90:@",
        "kind": None,
        "body": None,
        "upload": None,
    },
    {
        "number": 2,
        "kept": 1000.0,
        "id": "waiting",
        "caller": "us",
        "request_id": "r2",
        "status": "queued",
        "key": None,
        "digest": "",
        "problem": b"null",
        "members": b'{"points":0,"hypervolume":0.0,"hypervolume_bound":null,"timings_ms":{},"term'
        b'inated":null,"cities":0,"scale":null,"places":[],"reference_point":null,"act'
        b'or":{"name":"pa-one","digest":"ab12"}}',
        "tours": b"x\x01\x03\x00\x00\x00\x00\x01",
        "ends": b"",
        "angles": b"",
        "kind": "coverage",
        "body": b'{"cell_size": 1}',
        "upload": b"\x89PNG",
    },
    {
        "number": 3,
        "kept": 1000.0,
        "id": "lost",
        "caller": "us",
        "request_id": "r3",
        "status": "failed",
        "key": None,
        "digest": "",
        "problem": b'{"type":"about:blank","title":"Gateway Timeout","status":504,"code":"overdue'
        b'","detail":"the work must end in time, and there was no front yet","request_'
        b'id":"r3"}',
        "members": b'{"points":0,"hypervolume":0.0,"hypervolume_bound":null,"timings_ms":{},"term'
        b'inated":null,"cities":0,"scale":null,"places":[],"reference_point":null,"act'
        b'or":{"name":"pa-one","digest":"ab12"}}',
        "tours": b"x\x01\x03\x00\x00\x00\x00\x01",
        "ends": b"",
        "angles": b"",
        "kind": None,
        "body": None,
        "upload": None,
    },
]

REDIS_HASHES = {
    b"paretour:front:done": {
        b"caller": b"us",
        b"kept": b"1000",
        b"members": b'{"cities":3,"points":3,"hypervolume":0.277777777'
        b'7777778,"hypervolume_bound":null,"reference_poin'
        b't":[3.0,3.0],"scale":[1.0,1.0],"timings_ms":{"qu'
        b'eue":198.125,"construction":1.5,"improvement":50'
        b'.25,"selection":0.125,"bound":0.0,"total":250.0}'
        b',"terminated":"time_limit","actor":{"name":"pa-o'
        b'ne","digest":"ab12"},"places":[[0,0],[0,1],[1,0]]}',
        b"key": b"k",
        b"number": b"1",
        b"ends": b"p\x00\x00\x00\x00\x00\x00\x00\xe1\x00\x00\x00\x00\x00\x00\x00",
        b"id": b"done",
        b"angles": b"\x8cZ\xfc\xb4\xb5\x0cQ@\xc4\x1d\xa61\xa7\x90:@",
        b"gained": b"0.0625",
        b"digest": b"d1",
        b"tours": b"x\x01u\xcd=\n\xc30\x0c\x05\xe0\xbbh\x16Fr"
        b"\xeb\xdf\xab\x14\x0f!\x98dp\xd3\x92\xba\x93\xc9\xdd#"
        b"\x97\x14\x02\xa5\x8b@z\x0f}\r\x86e*\x19\xa2\xf5"
        b"\x8a\x837\x81\x0c_\xec\xd5\xb3G(y\x99\xea\xfc\x82"
        b"xcE\xa8\x95I\x08\xf5\xf1^\xe5@\xc8\xa8e}\x0eu\x86\xd8"
        b"`\xcc\xa5\xf4\xa2\x04\x94\xb0\xc7\x9fII:\xf7\\\xd7"
        b",\xa1<\xd96l_P[e\xac\x11\x8e\x9d#\xe7B8\x83Z"
        b"@\xe9\x9fA\xdd\x7f\xfe\x03\xf9`\x7f\xc1\x1d[\xf6>"
        b"\xa5",
        b"problem": b"null",
        b"request_id": b"r1",
        b"status": b"done",
    },
    b"paretour:front:running": {
        b"progress": b'{"seconds":0.5,"hypervolume":0.4375,"points":3}',
        b"seen": b"1000.5",
        b"caller": b"us",
        b"kept": b"1000",
        b"members": b'{"cities":3,"points":3,"hypervolume":0.277777777'
        b'7777778,"hypervolume_bound":null,"reference_poin'
        b't":[3.0,3.0],"scale":[1.0,1.0],"timings_ms":{},"'
        b'terminated":null,"actor":{"name":"pa-one","diges'
        b't":"ab12"}}',
        b"number": b"3",
        b"ends": b">\x00\x00\x00\x00\x00\x00\x00}\x00\x00\x00\x00\x00\x00\x00",
        b"id": b"running",
        b"angles": b"\x8cZ\xfc\xb4\xb5\x0cQ@\xc4\x1d\xa61\xa7\x90:@",
        b"digest": b"",
        b"problem": b"null",
        b"tours": b"x\x01M\xcc=\n\xc0 \x0c@\xe1\xbbd\x0eb\xd2"
        b"\xc6\xbf\xab\x14\x87\x0eb\x07\xb1\xd0\xda\xa9"
        b"x\xf7\xba\x14\\\x1f|\xef\x85\xbd\xe6\x92"
        b" \x18\xa7\xc8;\xf1Zh1\xab#\x87PR\xcd\xed\xb8!l\xa4"
        b"4\xb2\x92\x88\xd0\xce\xe7\x1aA#!\xc7"
        b"\x8e\xef\xcf\xd9(120Y\xab\xad\xf5~\xe6<\xf8"
        b"X\xcc\x9c\x91b\xff\x00D\x1b!\x99",
        b"worker": b"host:1:aa",
        b"request_id": b"r2",
        b"attempts": b"1",
        b"status": b"running",
    },
    b"paretour:front:waiting": {
        b"caller": b"us",
        b"kept": b"1000",
        b"members": b'{"points":0,"hypervolume":0.0,"hypervolume_bound'
        b'":null,"timings_ms":{},"terminated":null,"cities'
        b'":0,"scale":null,"places":[],"reference_point":n'
        b'ull,"actor":{"name":"pa-one","digest":"ab12"}}',
        b"number": b"2",
        b"ends": b"",
        b"id": b"waiting",
        b"angles": b"",
        b"digest": b"",
        b"problem": b"null",
        b"tours": b"x\x01\x03\x00\x00\x00\x00\x01",
        b"request_id": b"r2",
        b"status": b"queued",
    },
    b"paretour:work:running": {b"kind": b"front", b"body": b"{}"},
    b"paretour:work:waiting": {
        b"kind": b"coverage",
        b"body": b'{"cell_size": 1}',
        b"upload": b"\x89PNG",
    },
}

# In Redis, sorted sets of ids by their number.
REDIS_SETS = {
    b"paretour:finished": {b"done": 1},
    b"paretour:caller:us": {b"done": 1},
    b"paretour:unfinished": {b"waiting": 2, b"running": 3},
}

_RELEASED = {
    "done": b'{"id":"done","status":"done","cities":3,"points":3,"hypervolume":0.2777777777777'
    b'778,"hypervolume_bound":null,"reference_point":[3.0,3.0],"scale":[1.0,1.0],"timi'
    b'ngs_ms":{"queue":198.125,"construction":1.5,"improvement":50.25,"selection":0.12'
    b'5,"bound":0.0,"total":250.0},"terminated":"time_limit","actor":{"name":"pa-one",'
    b'"digest":"ab12"},"places":[[0,0],[0,1],[1,0]],"front":[{"angle":68.1985905136481'
    b'8,"lengths":[1.0,2.5],"tour":[0,1,2],"path":{"cells":[[0,0],[0,1],[0,0]],"metres'
    b'":1.0}},{"angle":26.56505117707799,"lengths":[2.0,1.0],"tour":[0,2,1],"path":{"c'
    b'ells":[[0,0],[1,0],[0,0]],"metres":1.0}}]}',
    "waiting": b'{"id":"waiting","status":"queued","points":0,"hypervolume":0.0,"hypervolume_'
    b'bound":null,"timings_ms":{},"terminated":null,"cities":0,"scale":null,"place'
    b's":[],"reference_point":null,"actor":{"name":"pa-one","digest":"ab12"},"fron'
    b't":[]}',
    "lost": b'{"id":"lost","status":"failed","problem":{"type":"about:blank","title":"Gateway '
    b'Timeout","status":504,"code":"overdue","detail":"the work must end in time, and '
    b'there was no front yet","request_id":"r3"},"points":0,"hypervolume":0.0,"hypervo'
    b'lume_bound":null,"timings_ms":{},"terminated":null,"cities":0,"scale":null,"plac'
    b'es":[],"reference_point":null,"actor":{"name":"pa-one","digest":"ab12"},"front":'
    b"[]}",
    "running": b'{"id":"running","status":"running","cities":3,"points":3,"hypervolume":0.277'
    b'7777777777778,"hypervolume_bound":null,"reference_point":[3.0,3.0],"scale":['
    b'1.0,1.0],"timings_ms":{},"terminated":null,"actor":{"name":"pa-one","digest"'
    b':"ab12"},"front":[{"angle":68.19859051364818,"lengths":[1.0,2.5],"tour":[0,1'
    b',2]},{"angle":26.56505117707799,"lengths":[2.0,1.0],"tour":[0,2,1]}]}',
}
# Its fronts did not say their kind, and its tours had no balance: they get theirs when read.
_KINDS = {"done": b"coverage", "waiting": b"coverage", "lost": b"coverage", "running": b"front"}


def _with_kind(answer: bytes, kind: bytes) -> bytes:
    return re.sub(
        rb'("status":"\w+",)("problem":\{.*?\},)?', rb'\1\2"kind":"%b",' % kind, answer, count=1
    )


ANSWERS = {
    id_: _with_kind(answer, _KINDS[id_])
    .replace(b',"lengths":[1.0,2.5]', b',"balance":0.0,"lengths":[1.0,2.5]')
    .replace(b',"lengths":[2.0,1.0]', b',"balance":1.0,"lengths":[2.0,1.0]')
    for id_, answer in _RELEASED.items()
}
