from .choose import Choice as Choice
