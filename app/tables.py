"""Every table of the service, loaded. Import this before the first query, so that foreign keys find their targets."""

from app.accounts import models as accounts
from app.batteries import models as batteries
from app.cars import models as cars
from app.drives import models as drives
from app.eco import models as eco
from app.health import models as health
from app.jobs import models as jobs
from app.maps import models as maps
from app.roads import models as roads
from app.storage.base import Base
from app.trips import models as trips
from app.uploads import models as uploads
from app.webhooks import models as webhooks

TABLE_MODULES = (accounts, cars, uploads, trips, maps, jobs, roads, webhooks, health, drives, eco, batteries)
METADATA = Base.metadata
