"""Limits of a small controller for asyncua, which by itself grants whatever is asked.

    limit(MS)                 before the server is made: it publishes no faster than this
    await declare(SERVER)     once it is made: the limits are said in its address space

Values are looked at every 250 ms, the queue of an item holds the newest one, 10 operations fit into a request, 20 items into a
subscription, 2 subscriptions into a session and 3 sessions into the server. Each value of an Int32 that goes out in a message is printed: "kept 7".
"""

import asyncio

from asyncua import ua
from asyncua.common.utils import ServiceError
from asyncua.server import internal_server, internal_session, internal_subscription, subscription_service
from asyncua.server.monitored_item_service import MonitoredItemService

SAMPLING_MS = 250
QUEUE = 1
OPERATIONS = 10
ITEMS = 20
SUBSCRIPTIONS = 2
SESSIONS = 3


class SampledItems(MonitoredItemService):
    """Looks at values now and then, where the original takes each change."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self._changed = {}
        self._sampler = asyncio.create_task(self._sample())

    async def _sample(self):
        while True:
            await asyncio.sleep(SAMPLING_MS / 1000)
            changed, self._changed = self._changed, {}
            for handle, value in changed.items():
                if handle in self._monitored_datachange:
                    await super().datachange_callback(handle, value)

    async def datachange_callback(self, handle, value, error=None):
        if error:
            await super().datachange_callback(handle, value, error)
        else:
            self._changed[handle] = value

    async def trigger_datachange(self, handle, nodeid, attr):
        # The first value of an item is due at once.
        await super().datachange_callback(handle, self.aspace.read_attribute_value(nodeid, attr))

    async def _create_data_change_monitored_item(self, params):
        if len(self._monitored_items) >= ITEMS:
            return ua.MonitoredItemCreateResult(StatusCode=ua.StatusCode(ua.StatusCodes.BadTooManyMonitoredItems))
        return await super()._create_data_change_monitored_item(params)

    def _make_monitored_item_common(self, params):
        result, data = super()._make_monitored_item_common(params)
        asked = params.RequestedParameters.SamplingInterval
        result.RevisedSamplingInterval = max(self.isub.data.RevisedPublishingInterval if asked < 0 else asked, SAMPLING_MS)
        return result, data

    def delete_all_monitored_items(self):
        self._sampler.cancel()
        super().delete_all_monitored_items()


class KeptSubscription(internal_subscription.InternalSubscription):
    """Says which values it publishes."""

    def _pop_triggered_datachanges(self, result):
        super()._pop_triggered_datachanges(result)
        for notification in result.NotificationMessage.NotificationData:
            for item in getattr(notification, "MonitoredItems", []):
                if item.Value.Value is not None and item.Value.Value.VariantType == ua.VariantType.Int32:
                    print("kept", item.Value.Value.Value, flush=True)


def limited_services(publishing_ms):
    class SmallSubscriptionService(subscription_service.SubscriptionService):
        async def create_subscription(self, params, callback, session_id, request_callback=None):
            if sum(known.session_id == session_id for known in self.subscriptions.values()) >= SUBSCRIPTIONS:
                raise ServiceError(ua.StatusCodes.BadTooManySubscriptions)
            params.RequestedPublishingInterval = max(params.RequestedPublishingInterval, publishing_ms)
            return await super().create_subscription(params, callback, session_id, request_callback)

    return SmallSubscriptionService


def counted(service, operations):
    """A service of a session that refuses more operations than a small controller takes."""

    def limited(session, params):
        if session.external and len(operations(params)) > OPERATIONS:
            raise ServiceError(ua.StatusCodes.BadTooManyOperations)
        return service(session, params)

    return limited


def limit(publishing_ms):
    internal_server.SubscriptionService = limited_services(publishing_ms)
    subscription_service.InternalSubscription = KeptSubscription
    internal_subscription.MonitoredItemService = SampledItems
    operations = {
        "read": lambda params: params.NodesToRead,
        "write": lambda params: params.NodesToWrite,
        "browse": lambda params: params.NodesToBrowse,
        "translate_browsepaths_to_nodeids": lambda paths: paths,
        "create_monitored_items": lambda params: params.ItemsToCreate,
        "delete_monitored_items": lambda params: params.MonitoredItemIds,
    }
    session = internal_session.InternalSession
    for name, of in operations.items():
        setattr(session, name, counted(getattr(session, name), of))
    register = internal_server.InternalServer.register_external_session

    def register_if_there_is_room(server, session):
        if len(server._external_sessions) >= SESSIONS:
            raise ServiceError(ua.StatusCodes.BadTooManySessions)
        register(server, session)

    internal_server.InternalServer.register_external_session = register_if_there_is_room


async def declare(server):
    server.iserver.max_monitored_item_queue_size = QUEUE
    ids = ua.ObjectIds
    limits = "Server_ServerCapabilities_OperationLimits_"
    declared = {
        limits + "MaxNodesPerRead": OPERATIONS,
        limits + "MaxNodesPerWrite": OPERATIONS,
        limits + "MaxNodesPerBrowse": OPERATIONS,
        limits + "MaxNodesPerTranslateBrowsePathsToNodeIds": OPERATIONS,
        limits + "MaxMonitoredItemsPerCall": OPERATIONS,
        "Server_ServerCapabilities_MaxMonitoredItemsPerSubscription": ITEMS,
        "Server_ServerCapabilities_MaxSubscriptionsPerSession": SUBSCRIPTIONS,
        "Server_ServerCapabilities_MaxSessions": SESSIONS,
        "Server_ServerCapabilities_MaxMonitoredItemsQueueSize": QUEUE,
    }
    for name, value in declared.items():
        await server.get_node(ua.NodeId(getattr(ids, name))).write_value(ua.Variant(value, ua.VariantType.UInt32))
