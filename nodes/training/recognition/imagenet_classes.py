"""The classes of ImageNet that are things of a household, with our classes that such a thing may be of."""

from __future__ import annotations

from semmap.nodes.perception_node.recognition.recognition_model import UNKNOWN

_THINGS = """
Bin 412 427; Backpack 414; Pen 418 563; Chair 423 559 765 857; Ball 429 430 522 574 722 768 805 852
Towel 434 533 591; Bathtub 435 876; Bottle 440 631 711 737 804 838 898; Bottle+Wine 907; Bottle+Drug 720
Bottle+Can 585; Bottle+Can+Jar 503; Can+Jar 653; Glass 438 441 572; Cup+Glass 969; Folder 446
Bookshelf 453; Broom 462 840; Bucket 463; Candle 470; Utensil 473 512 813 828; Box+Carton+Cereals 478 692
Box 519 771; Box+Case 492 709; Radio 482 485 754 848; Smartphone+Phone 487 590 605; Phone 528 707
Cabinet 493 495 548 553 648; Knife 499 623; Shoes 502 514 630 770 774; Cup 504 647 967 968
Pot+Kettle+Pitcher 505; Kettle+Pot 849; Pitcher 725 899; Pitcher+Jar 901; Keyboard 508 810 878
Bed 431 516 520 564; Pot 469 521 544; Desk 526; Computer 527; Wristwatch 531; Table 532; Dishwasher 534
Fan 545; Envelope 549; Coffee_Machine 550; Pan 567 909; Hammer 587; Basket 588 790; Iron 606
Clothes 411 474 501 568 578 608 610 614 617 655 658 697 735 806 834 841 869
Hat 433 452 515 518 560 667 793 808; Spoon 618 910; Lamp 619 818 846; Laptop 620 681; Speaker 632
Television+Speaker 598; Bag 636 728 748; Microwave 651; Bowl 659 666 809; Router 662; Monitor 664 782
Television+Monitor 851; Toilet_Paper 700 999; Bench 703; Printer 713 742; Pillow 721; Flower_Pot+Plant 738
Camera 732 759; Fridge 760; Remote_Control 761; Oven 766; Screwdriver 784; Stove 827; Couch 831
Glasses 836 837; Toaster 859; Toilet 861; Tray 868; Umbrella 879; Vacuum_Cleaner 882; Vase 883; Wallet 893
Wardrobe 894; Sink 896; Washing_Machine 897; Book+Magazine 917; Book+Box+Cereals 921; Newspaper 918
Paper+Magazine 922; Plate 923; Bread 930 931; Apple 948; Fruit 949 952 953 955 956 957; Orange 950
Lemon 951; Banana 954; Corn 987 998
Object 398 404 409 419 422 447 455 464 477 481 491 507 530 539 542 543 551 558 584 589 592 593 596 600 604
Object 611 613 622 626 629 633 635 637 641 644 650 673 677 679 680 684 688 695 696 710 712 719 726 731 740
Object 745 746 752 758 767 769 772 773 778 783 786 792 798 811 823 826 844 845 850 855 872 891 892 902
"""
"""Our classes and the numbers of theirs, in the usual order of the 1000 classes."""


def classes_by_number() -> dict[int, tuple[str, ...]]:
    """Return for the numbers of ImageNet's classes ours, of which `Object` is none of the others."""
    found: dict[int, tuple[str, ...]] = {}
    for entry in _THINGS.replace("\n", ";").split(";"):
        names, *numbers = entry.split() or [UNKNOWN]
        found |= {int(number): tuple(names.split("+")) for number in numbers}
    return found
