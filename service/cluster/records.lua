-- The verbs of the script. Each call happens for everybody at once, or not at all.
-- ARGV: the verb, the time in seconds, and the arguments of the verb. stored_records.lua comes before.

-- Counts of fields come before them, because a list of lists cannot be given.
local function rest(first) return {unpack(ARGV, first)} end
local function split(first)
  local count = tonumber(ARGV[first])
  return {unpack(ARGV, first + 1, first + count)}, rest(first + 1 + count)
end

local verbs = {}

function verbs.make_way(now)
  local max_age, entries, tombstones, bytes = unpack(ARGV, 3, 6)
  make_way(now, tonumber(max_age), tonumber(entries), tonumber(tombstones), tonumber(bytes))
end

function verbs.put(now)
  local id, fields, work = ARGV[3], split(4)
  put(now, id, fields, work)
end

-- The reply to a repeat; nil if the record repeats nothing, or only one that failed.
local function repeated(caller, key, digest)
  local earlier = key ~= '' and redis.call('GET', key_of(caller, key))
  if not earlier then return nil end
  local same, status = unpack(redis.call('HMGET', front_of(earlier), 'digest', 'status'))
  if not same then return nil end -- it was damaged
  if same ~= digest then return 'mismatch' end
  if status ~= 'failed' then return {earlier, redis.call('HGETALL', front_of(earlier))} end
end

function verbs.repeated(_)
  return repeated(unpack(ARGV, 3, 5)) or 'new'
end

local function admit(now, first)
  local id, caller, key, digest = unpack(ARGV, first, first + 3)
  local fields, work = split(first + 4)
  local reply = repeated(caller, key, digest)
  if reply then return reply end
  local failed = key ~= '' and redis.call('GET', key_of(caller, key))
  if failed then redis.call('HDEL', front_of(failed), 'key') end
  put(now, id, fields, work)
  return 'new'
end

function verbs.admit(now) return admit(now, 3) end

function verbs.get(_)
  local caller, id = unpack(ARGV, 3, 4)
  if redis.call('HGET', front_of(id), 'caller') == caller then
    return {id, redis.call('HGETALL', front_of(id))}
  end
  return redis.call('SISMEMBER', gone_of(caller), id) == 1 and 'expired' or 'unknown'
end

function verbs.latest(_)
  local caller, client = ARGV[3], ARGV[4]
  for _, id in ipairs(redis.call('ZREVRANGE', owned_by(client), 0, -1)) do
    local its = redis.call('HGET', front_of(id), 'caller')
    -- A damaged record may lack its caller. The replica that reads it drops it.
    if not its or its == caller then return {id, redis.call('HGETALL', front_of(id))} end
  end
  return redis.call('EXISTS', gone_of(client)) == 1 and 'expired' or 'unknown'
end

-- The id, number, time and status of a caller's newest records for a client, the newest first, with
-- numbers below one.
function verbs.page(_)
  local caller, client, highest, most = ARGV[3], ARGV[4], '(' .. ARGV[5], tonumber(ARGV[6])
  local found = {}
  local function take(id)
    local its, number, kept, status, members = unpack(
      redis.call('HMGET', front_of(id), 'caller', 'number', 'kept', 'status', 'members'))
    if its ~= caller or not (tonumber(number) and kept and status and members) then return end
    found[#found + 1] = {id, number, kept, status}
  end
  for _, id in ipairs(redis.call('ZREVRANGEBYSCORE', UNFINISHED, highest, '-inf')) do
    if client_of(id) == client then take(id) end
  end
  local unfinished = #found
  for _, id in ipairs(redis.call('ZREVRANGEBYSCORE', owned_by(client), highest, '-inf')) do
    if #found - unfinished == most then break end
    take(id)
  end
  table.sort(found, function(one, other) return tonumber(one[2]) > tonumber(other[2]) end)
  return {unpack(found, 1, math.min(#found, most))}
end

function verbs.members(_) return redis.call('HGET', front_of(ARGV[3]), 'members') end

function verbs.source(_) return redis.call('HGETALL', work_of(ARGV[3])) end

function verbs.forget(_) forget(ARGV[3]) end

-- Drop a record that cannot be read, and tell those who follow it that it has ended.
function verbs.drop(_)
  local id, caller = ARGV[3], ARGV[4]
  drop(id, caller)
  redis.call('PUBLISH', TOLD, id .. ':failed')
end

function verbs.repair(_) repair(ARGV[3]) end

function verbs.messages(_) return redis.call('LLEN', ARGV[3]) end

-- How many workers there are. It writes something, because only then Redis says that it is full.
function verbs.write(now)
  redis.call('SET', P .. 'written', now)
  redis.call('ZREMRANGEBYSCORE', WORKERS, '-inf', now - 5)
  return redis.call('ZCARD', WORKERS)
end

function verbs.unfinished(_)
  local found = {}
  for index, id in ipairs(redis.call('ZRANGE', UNFINISHED, 0, -1)) do
    found[index] = {id, redis.call('HGETALL', front_of(id)), redis.call('HGETALL', work_of(id))}
  end
  return found
end

-- Some deliveries that are due: id, webhook, status, end and attempts of each.
function verbs.due_deliveries(now)
  local most, seconds = tonumber(ARGV[3]), tonumber(ARGV[4])
  local found = {}
  for _, id in ipairs(redis.call('ZRANGEBYSCORE', DELIVERIES, '-inf', now, 'LIMIT', 0, most)) do
    redis.call('ZADD', DELIVERIES, now + seconds, id)
    redis.call('HINCRBY', delivery_of(id), 'attempts', 1)
    local fields = redis.call('HMGET', delivery_of(id), 'webhook', 'status', 'ended', 'attempts')
    found[#found + 1] = {id, unpack(fields)}
  end
  return found
end

function verbs.postpone(now)
  redis.call('ZADD', DELIVERIES, 'XX', now + tonumber(ARGV[4]), ARGV[3])
end

function verbs.remove_delivery(_) remove_delivery(ARGV[3]) end

-- The other verbs are for records that are being planned.

local function tell(id)
  redis.call('PUBLISH', TOLD, id .. ':' .. redis.call('HGET', front_of(id), 'status'))
end

local function workers_at(now)
  redis.call('ZREMRANGEBYSCORE', WORKERS, '-inf', now - 5)
  return redis.call('ZCARD', WORKERS)
end

-- A script may write when Redis is full, once it has removed something. So workers stay registered.
function verbs.present(now)
  workers_at(now)
  redis.call('ZADD', WORKERS, now, ARGV[3])
end

-- How many workers a machine has, how many messages wait, and which of its workers have no record.
function verbs.idle(now)
  local machine, messages = ARGV[3] .. ':', ARGV[4]
  workers_at(now)
  local busy = {}
  for _, id in ipairs(redis.call('ZRANGE', UNFINISHED, 0, -1)) do
    local status, worker = unpack(redis.call('HMGET', front_of(id), 'status', 'worker'))
    if status == 'running' then busy[worker] = true end
  end
  local here, idle = 0, {}
  for _, worker in ipairs(redis.call('ZRANGE', WORKERS, 0, -1)) do
    if string.sub(worker, 1, #machine) == machine then
      here = here + 1
      if not busy[worker] then idle[#idle + 1] = worker end
    end
  end
  return {here, redis.call('LLEN', messages), idle}
end

-- How many records wait and are being planned; how many workers were lost, and are alive.
function verbs.standing(now)
  local working = 0
  for _, id in ipairs(redis.call('ZRANGE', UNFINISHED, 0, -1)) do
    if redis.call('HGET', front_of(id), 'status') == 'running' then working = working + 1 end
  end
  local waiting = redis.call('ZCARD', UNFINISHED) - working
  local alive = redis.call('ZCOUNT', WORKERS, '(' .. now - 5, '+inf')
  return {waiting, working, tonumber(redis.call('GET', LOST) or 0) or 0, alive}
end

-- The refusal of one more record of a client, where it has no place: 'full', or how many it may have.
local function refusal(now)
  local queue, share, client = tonumber(ARGV[3]), tonumber(ARGV[4]), ARGV[5]
  local workers, held = workers_at(now), 0
  local unfinished = redis.call('ZRANGE', UNFINISHED, 0, -1)
  if #unfinished >= workers + queue then return 'full' end
  for _, id in ipairs(unfinished) do
    local its, caller = unpack(redis.call('HMGET', front_of(id), 'client', 'caller'))
    if (its or caller) == client then held = held + 1 end
  end
  local most = math.max(math.ceil(share * (workers + queue)), workers + 1)
  if held >= most then return most end
end

function verbs.check_place(now) return refusal(now) or 'new' end

-- Admit a record and give it a place. A client that waits for the front needs a worker now.
function verbs.submit(now)
  local waits = ARGV[6] ~= ''
  local reply = repeated(unpack(ARGV, 8, 10)) or (waits and workers_at(now) == 0 and 'alone')
    or refusal(now)
  if reply then return reply end
  reply = admit(now, 7)
  redis.call('HSET', front_of(ARGV[7]), 'client', ARGV[5])
  return reply
end

-- The record that waits and is next, in the order of service/jobs/fair_queue.py: clients without a
-- running record come first, and among them newcomers, then those whose last turn is longest ago.
local function next_in_turn()
  local first, waiting, served = {}, {}, {}
  for _, id in ipairs(redis.call('ZRANGE', UNFINISHED, 0, -1)) do
    local status, seen, client, caller =
      unpack(redis.call('HMGET', front_of(id), 'status', 'seen', 'client', 'caller'))
    client = client or caller or ''
    if status == 'running' then
      served[client] = true
    elseif status == 'queued' and seen then
      return id -- A worker handed it back: this is still the same turn.
    elseif status == 'queued' and not first[client] then
      first[client] = id
      waiting[#waiting + 1] = client
    end
  end
  local found, least
  for _, client in ipairs(waiting) do
    local turn = tonumber(redis.call('ZSCORE', TURNS, client) or 0)
    if served[client] then turn = turn + 2 ^ 40 end -- behind all others
    if not least or turn < least then found, least = client, turn end
  end
  if not found then return nil end
  redis.call('ZADD', TURNS, redis.call('INCR', TURN), found)
  redis.call('ZREMRANGEBYRANK', TURNS, 0, -1001) -- the latest 1000 are remembered
  return first[found]
end

-- The record that a worker plans for a message. A message stands for a turn, which is that of the
-- next record. If the message comes again because its worker is lost, it is the same record.
local function record_of(now, message, lease, known)
  for _, id in ipairs(redis.call('ZRANGE', UNFINISHED, 0, -1)) do
    local status, seen, began_by = unpack(redis.call('HMGET', front_of(id), 'status', 'seen', 'message'))
    if status == 'running' then
      local unseen = now - (tonumber(seen) or 0) >= lease
      local same = (began_by or id) == message
      if (same and (unseen or known ~= '')) or (id == message and unseen) then return id end
    end
  end
  return next_in_turn()
end

-- Nothing if no record waits and no record has lost the worker of this message.
function verbs.begin(now)
  local message, worker, lease, known = ARGV[3], ARGV[4], tonumber(ARGV[5]), ARGV[6]
  local id = record_of(now, message, lease, known)
  if not id then return false end
  redis.call(
    'HSET', front_of(id), 'status', 'running', 'worker', worker, 'seen', now, 'message', message
  )
  if redis.call('HINCRBY', front_of(id), 'attempts', 1) > 1 then redis.call('INCR', LOST) end
  tell(id)
  return {id, redis.call('HGETALL', front_of(id)), redis.call('HGETALL', work_of(id))}
end

local function has(id, worker) return redis.call('HGET', front_of(id), 'worker') == worker end

-- A worker still plans the record. The reply says why it is to stop, if it is.
function verbs.seen(now)
  local id, worker = ARGV[3], ARGV[4]
  if not has(id, worker) then return 'taken' end
  redis.call('HSET', front_of(id), 'seen', now)
  return redis.call('HGET', front_of(id), 'stop') or ''
end

function verbs.progress(_)
  local id, worker = ARGV[3], ARGV[4]
  if has(id, worker) then
    redis.call('HSET', front_of(id), unpack(ARGV, 5))
    tell(id)
  end
end

-- A worker that shuts down leaves the record to another. This does not count as an attempt.
function verbs.hand_back(now)
  local id, worker = ARGV[3], ARGV[4]
  if has(id, worker) then
    redis.call('HSET', front_of(id), 'status', 'queued', 'sent', now)
    redis.call('HDEL', front_of(id), 'worker')
    redis.call('HINCRBY', front_of(id), 'attempts', -1)
    tell(id)
  end
end

function verbs.stop(_)
  local id, why = ARGV[3], ARGV[4]
  if redis.call('EXISTS', front_of(id)) == 1 then redis.call('HSETNX', front_of(id), 'stop', why) end
end

-- Only the first end of a record counts. Its source is stored already, and stays unless it failed.
function verbs.finish(now)
  local id, fields = ARGV[3], split(4)
  local status = redis.call('HGET', front_of(id), 'status')
  if status and not is_finished(status) then
    local work = redis.call('HGETALL', work_of(id))
    put(now, id, fields, work)
    if redis.call('HGET', front_of(id), 'status') == 'failed' then drop_source(id) end
    tell(id)
  end
end

-- The fields of a record that is done, for the first replica that asks.
function verbs.claim(_)
  local id = ARGV[3]
  if redis.call('HGET', front_of(id), 'status') ~= 'done' then return false end
  if redis.call('HSETNX', front_of(id), 'claimed', 1) == 0 then return false end
  return redis.call('HGETALL', front_of(id))
end

-- The records whose worker was not seen for the time of a lease, or whose message is lost, unless
-- they were sent again within that time.
function verbs.stale(now)
  local lease, messages = tonumber(ARGV[3]), ARGV[4]
  local found = {}
  for _, id in ipairs(redis.call('ZRANGE', UNFINISHED, 0, -1)) do
    local status, seen, sent, kept =
      unpack(redis.call('HMGET', front_of(id), 'status', 'seen', 'sent', 'kept'))
    local left = status == 'queued' and redis.call('LLEN', messages) == 0
    local lost = status == 'running' and now - seen > lease
    if (left or lost) and now - (sent or kept) > lease then
      redis.call('HSET', front_of(id), 'sent', now)
      found[#found + 1] = id
    end
  end
  return found
end

return verbs[ARGV[1]](tonumber(ARGV[2]))
