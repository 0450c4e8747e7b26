"""The classes of ImageNet that are things of a household, with our classes that such a thing may be of."""

from __future__ import annotations

from semmap.nodes.perception_node.recognition.recognition_model import UNKNOWN

_THINGS = """
Bin 412; Backpack 414; Pen 418 563; Chair 423 559 765; Ball 429 430 522 574 722 768 805 852; Towel 434
Bathtub 435 876; Bottle 440 631 711 737 838 898; Bottle+Wine 907; Bottle+Drug 720; Glass 441 572; Folder 446
Bookshelf 453; Broom 462; Bucket 463; Candle 470; Utensil 473 813 828; Box+Carton+Cereals 478 692; Box 519
Radio 482 848; Smartphone+Phone 487 590 605; Phone 528; Cabinet 495 553; Knife 499 623; Shoes 502 770 774
Cup 504 647 967 968; Pot+Kettle+Pitcher 505; Kettle+Pot 849; Keyboard 508 810 878; Bed 520 564; Pot 521 544
Desk 526; Computer 527; Wristwatch 531; Table 532; Dishwasher 534; Fan 545; Envelope 549; Coffee_Machine 550
Pan 567 909; Hammer 587; Basket 588 790; Iron 606; Clothes 608 610 806 841; Spoon 618 910; Lamp 619 846
Laptop 620 681; Speaker 632; Bag 636 728 748; Microwave 651; Bowl 659 809; Monitor 664; Toilet_Paper 700 999
Bench 703; Box+Case 709; Printer 713 742; Pillow 721; Pitcher 725 899; Flower_Pot+Plant 738; Camera 732 759
Fridge 760; Remote_Control 761; Screwdriver 784; Stove 827; Couch 831; Glasses 836 837
Television+Monitor 851; Toaster 859; Toilet 861; Tray 868; Umbrella 879; Vacuum_Cleaner 882; Vase 883
Wallet 893; Wardrobe 894; Sink 896; Washing_Machine 897; Book+Magazine 917; Book+Box+Cereals 921; Plate 923
Bread 930 931; Apple 948; Fruit 949 952 953 957; Orange 950; Lemon 951; Banana 954; Corn 987 998
Object 404 447 477 507 543 589 613 633 673 695 740 767 769 778 844 850
"""
"""Our classes and the numbers of theirs, in the usual order of the 1000 classes."""


def classes_by_number() -> dict[int, tuple[str, ...]]:
    """Return for the numbers of ImageNet's classes ours, of which `Object` is none of the others."""
    found: dict[int, tuple[str, ...]] = {}
    for entry in _THINGS.replace("\n", ";").split(";"):
        names, *numbers = entry.split() or [UNKNOWN]
        found |= {int(number): tuple(names.split("+")) for number in numbers}
    return found
