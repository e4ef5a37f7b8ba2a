-- How records are stored, found by their callers, counted, and dropped. records.lua follows.

-- A call that fails because a key holds what is not ours fails with the name of the key.
local server = redis
local redis = {}
function redis.call(...)
  local reply = server.pcall(...)
  if type(reply) ~= 'table' or not reply.err then return reply end
  local key = select(2, ...)
  if string.find(reply.err, 'WRONGTYPE', 1, true) or string.find(reply.err, 'ERR value is not', 1, true) then
    error('damaged ' .. cjson.encode(key) .. ': ' .. reply.err)
  end
  return server.call(...) -- which fails again, as it would have without this
end

local P = 'paretour:'
local NUMBER, LOST = P .. 'number', P .. 'lost'
local UNFINISHED, FINISHED, GONE = P .. 'unfinished', P .. 'finished', P .. 'gone'
-- The number of each client's latest turn; and the number of the latest turn of all.
local TURNS, TURN = P .. 'turns', P .. 'turn'
-- When the delivery of each ended job to its webhook is due.
local DELIVERIES = P .. 'deliveries'
local WORKERS, TOLD = P .. 'workers', P .. 'told'
-- Of finished records: how many each client has and of how many bytes, the bytes of all, and
-- whether this was counted lately. A client is a caller, or an address where there are no keys.
local ENTRIES, BYTES = P .. 'entries', P .. 'bytes'
local TOTAL, COUNTED = P .. 'total', P .. 'counted'

local function front_of(id) return P .. 'front:' .. id end
local function work_of(id) return P .. 'work:' .. id end
-- Read by replicas of earlier releases alone, which look up a caller's latest front in it.
local function all_of(caller) return P .. 'caller:' .. caller end
local function owned_by(client) return P .. 'client:' .. client end
local function gone_of(caller) return P .. 'gone:' .. caller end
local function key_of(caller, key) return P .. 'key:' .. caller .. ':' .. key end

local function delivery_of(id) return P .. 'delivery:' .. id end

local function is_finished(status) return status ~= 'queued' and status ~= 'running' end

-- Count what a client has more, or less.
local function count(client, entries, size)
  redis.call('INCRBY', TOTAL, size)
  redis.call('ZINCRBY', BYTES, size, client)
  if tonumber(redis.call('ZINCRBY', ENTRIES, entries, client)) <= 0 then
    redis.call('ZREM', BYTES, client)
    redis.call('ZREM', ENTRIES, client)
  end
end

-- Replicas of earlier releases name no client.
local function client_of(id)
  local client, caller = unpack(redis.call('HMGET', front_of(id), 'client', 'caller'))
  return client or caller
end

-- The caller is named where the record may be damaged.
local function forget(id, known)
  local caller, key, size = unpack(redis.call('HMGET', front_of(id), 'caller', 'key', 'size'))
  local client = client_of(id)
  caller, size = known or caller, tonumber(size)
  if caller then redis.call('ZREM', all_of(caller), id) end
  redis.call('ZREM', UNFINISHED, id)
  local finished = redis.call('ZREM', FINISHED, id) == 1
  if finished and client then
    redis.call('ZREM', owned_by(client), id)
    if size then count(client, -1, -size) end
  end
  if key and redis.call('GET', key_of(caller, key)) == id then
    redis.call('DEL', key_of(caller, key))
  end
  -- Last, so that it is still there where a key before holds what is not ours.
  redis.call('DEL', front_of(id), work_of(id))
end

-- The bytes of values, without the names that stand before each.
local function size_of(fields)
  local size = 0
  for index = 2, #fields, 2 do size = size + #fields[index] end
  return size
end

local function keep_work(id, fields)
  if #fields > 0 then redis.call('HSET', work_of(id), unpack(fields)) end
end

local function remove_delivery(id)
  redis.call('ZREM', DELIVERIES, id)
  redis.call('DEL', delivery_of(id))
end

-- Have the end of a record delivered to its webhook, once.
local function add_delivery(now, id, status)
  local webhook = redis.call('HGET', front_of(id), 'webhook')
  if not webhook then return end
  redis.call('HDEL', front_of(id), 'webhook')
  redis.call('HSET', delivery_of(id), 'webhook', webhook, 'status', status, 'ended', now)
  redis.call('ZADD', DELIVERIES, now, id)
  for _, last in ipairs(redis.call('ZRANGE', DELIVERIES, 10000, -1)) do remove_delivery(last) end
end

-- The source comes as the fields `work`.
local function put(now, id, fields, work)
  local number = redis.call('INCR', NUMBER)
  forget(id)
  redis.call('HSET', front_of(id), 'number', number, 'kept', now, unpack(fields))
  local status, caller, key =
    unpack(redis.call('HMGET', front_of(id), 'status', 'caller', 'key'))
  if is_finished(status) then
    redis.call('ZADD', FINISHED, number, id)
    redis.call('ZADD', all_of(caller), number, id)
    local size = size_of(fields) + size_of(work)
    redis.call('HSET', front_of(id), 'size', size)
    redis.call('ZADD', owned_by(client_of(id)), number, id)
    count(client_of(id), 1, size)
    add_delivery(now, id, status)
  else
    redis.call('ZADD', UNFINISHED, number, id)
  end
  if key then redis.call('SET', key_of(caller, key), id) end
  keep_work(id, work)
end

-- Remember that a record was there, and forget all else of it.
local function drop(id, known)
  local caller = known or redis.call('HGET', front_of(id), 'caller')
  local client = client_of(id)
  forget(id, caller)
  local function bury(whose)
    redis.call('ZADD', GONE, redis.call('INCR', NUMBER), whose .. ':' .. id)
    redis.call('SADD', gone_of(whose), id)
  end
  if caller then bury(caller) end
  if client and client ~= caller then bury(client) end
end

-- Count everything anew, once a minute: replicas of earlier releases do not count.
local function count_again()
  if redis.call('EXISTS', COUNTED) == 1 then return end
  redis.call('DEL', ENTRIES, BYTES, TOTAL)
  for _, id in ipairs(redis.call('ZRANGE', FINISHED, 0, -1)) do
    local client, size = client_of(id), tonumber(redis.call('HGET', front_of(id), 'size'))
    if client and not size then
      size = size_of(redis.call('HGETALL', front_of(id)))
      redis.call('HSET', front_of(id), 'size', size)
    end
    if client then
      redis.call('ZADD', owned_by(client), redis.call('ZSCORE', FINISHED, id), id)
      count(client, 1, size)
    end
  end
  redis.call('SET', COUNTED, 1, 'EX', 60)
end

local function oldest_of(client) return redis.call('ZRANGE', owned_by(client), 0, 0, 'WITHSCORES') end

-- The oldest record of the client with most entries; of several such, the oldest of all.
local function next_of_most_entries()
  local most = redis.call('ZREVRANGE', ENTRIES, 0, 0, 'WITHSCORES')[2]
  local found, owner, least
  for _, client in ipairs(
    most and redis.call('ZRANGEBYSCORE', ENTRIES, most, most, 'LIMIT', 0, 100) or {}
  ) do
    local id, number = unpack(oldest_of(client))
    number = tonumber(number)
    if id and (not least or number < least) then found, owner, least = id, client, number end
  end
  return found, owner
end

-- The oldest record of the client with most bytes; of those with one alone where nobody has two.
local function next_of_most_bytes()
  local most = tonumber(redis.call('ZREVRANGE', ENTRIES, 0, 0, 'WITHSCORES')[2] or 0)
  for _, client in ipairs(redis.call('ZREVRANGE', BYTES, 0, 99)) do
    if most <= 1 or redis.call('ZCARD', owned_by(client)) > 1 then
      return oldest_of(client)[1], client
    end
  end
  return next_of_most_entries()
end

local function total() return tonumber(redis.call('GET', TOTAL) or 0) or 0 end

local function drop_source(id)
  local source = size_of(redis.call('HGETALL', work_of(id)))
  redis.call('DEL', work_of(id))
  redis.call('HINCRBY', front_of(id), 'size', -source)
  count(client_of(id), 0, -source)
end

local function size_of_record(id) return tonumber(redis.call('HGET', front_of(id), 'size')) or 0 end

-- Drop sources that would take more than a quarter of the store, and records that no store of so
-- many bytes could hold.
local function drop_too_large(bytes)
  local most = math.floor(bytes / 4)
  for _, client in ipairs(redis.call('ZREVRANGEBYSCORE', BYTES, '+inf', '(' .. most)) do
    for _, id in ipairs(redis.call('ZRANGE', owned_by(client), 0, -1)) do
      if size_of_record(id) > most and size_of(redis.call('HGETALL', work_of(id))) > most then
        drop_source(id)
      end
      if size_of_record(id) > bytes then drop(id) end
    end
  end
end

-- Enter all records anew in the lists that they are found by.
local function list_again()
  local last = 0
  for _, key in ipairs(redis.call('KEYS', front_of('*'))) do
    if server.call('TYPE', key).ok == 'hash' then
      local id = string.sub(key, #front_of('') + 1)
      local number, status, caller = unpack(redis.call('HMGET', key, 'number', 'status', 'caller'))
      number = tonumber(number) or 0
      last = math.max(last, number)
      if status and is_finished(status) then
        redis.call('ZADD', FINISHED, number, id)
        if caller then redis.call('ZADD', all_of(caller), number, id) end
      elseif status then
        redis.call('ZADD', UNFINISHED, number, id)
      end
    end
  end
  if tonumber(redis.call('GET', NUMBER) or 0) < last then redis.call('SET', NUMBER, last) end
  redis.call('DEL', COUNTED)
end

-- Put a key that holds what is not ours aside, and make it anew from the records.
local function repair(key)
  if redis.call('EXISTS', key) == 1 then redis.call('RENAME', key, P .. 'damaged') end
  list_again()
end

local function make_way(now, max_age, entries, tombstones, bytes)
  local function oldest() return redis.call('ZRANGE', FINISHED, 0, 0)[1] end
  local old = oldest()
  while old do
    local kept = tonumber(redis.call('HGET', front_of(old), 'kept'))
    if kept and kept >= now - max_age then break end
    drop(old)
    old = oldest()
  end
  count_again()
  drop_too_large(bytes)
  old = oldest()
  while old do
    local id, client
    if redis.call('ZCARD', FINISHED) > entries then
      id, client = next_of_most_entries()
    elseif total() > bytes then
      id, client = next_of_most_bytes()
    else
      break
    end
    -- Where the counts are wrong there may be none, or one that is damaged or gone.
    drop(id or old)
    if id then redis.call('ZREM', owned_by(client), id) end
    old = oldest()
  end
  while redis.call('ZCARD', GONE) > tombstones do
    local caller, id = string.match(redis.call('ZPOPMIN', GONE)[1], '^(.*):(.*)$')
    if caller then redis.call('SREM', gone_of(caller), id) end
  end
end
